// `render`: the picture by distributed rays over lens and time, the reference that post-processed pictures
// are held against.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "lens/aperture.h"
#include "lens/focus_geometry.h"
#include "lens/prescription/prescription.h"
#include "lens/shutter_curve.h"
#include "records/image.h"
#include "tracer/camera_model.h"
#include "tracer/distributed_tracer.h"
#include "tracer/ray_scene.h"
#include "tracer/sampler.h"
#include "tracer/scene.h"

namespace postlens {

struct RenderSettings {
    CameraOverrides camera;
    std::string camera_name;       ///< empty: the scene's first
    std::optional<double> time_s;  ///< the instant without a shutter; absent: the scene's own

    std::optional<double> focal_length_mm;              ///< F; absent: the film distance of the camera
    std::optional<double> f_number;                     ///< absent: the camera's; a pinhole where it has none
    std::optional<double> focus_m;                      ///< absent: the camera's
    std::optional<std::pair<double, double>> focus_at;  ///< raster px; instead of focus_m
    Framing framing = Framing::keep;
    std::shared_ptr<const Aperture> aperture;  ///< none: the disc
    /// A real lens instead of the thin one: `focal_length_mm` must be absent, `f_number` absent is wide open.
    std::shared_ptr<const Prescription> prescription;

    std::optional<TimeSpan> shutter;  ///< absent: open for an instant only
    ShutterCurve curve = ShutterCurve::box();

    SamplerKind sampler = SamplerKind::sobol;
    int spp = 64;  ///< samples per pixel; with `halves` even
    std::uint64_t seed = 0;
    bool halves = false;  ///< two independent halves of the samples, each a picture of its own
    bool resume = false;  ///< go on from what an interrupted run left
    DistributedSettings tracing;

    double metres_per_unit = 1;        ///< as the scene was read; only recorded
    double checkpoint_interval_s = 5;  ///< how often the picture so far is written
    /// What of the picture is wanted: tiles of 8 px that have nothing of it stay black. The others have the
    /// same bits as without; files hold the crop alone (see write_image). A run may go on from what one with
    /// another crop has left.
    std::optional<Crop> crop;
};

struct RenderResult {
    Image image;
    std::array<Image, 2> halves;  ///< empty without `halves`
    RayCounts rays;               ///< of this run
    bool resumed = false;         ///< went on from what an interrupted run left
    int spp_resumed = 0;          ///< samples per pixel (at least) that were there from the run before
    double seconds_render = 0;    ///< tracing alone
    double focal_length_mm = 0, f_number = 0, focus_m = 0;  ///< as resolved
    double motion_error_px = 0;  ///< how far Embree's steps stray from the true motion of meshes
};

/// The two files of `halves`: NAME.a.EXT and NAME.b.EXT.
[[nodiscard]] std::array<std::filesystem::path, 2> half_paths(const std::filesystem::path& path);
/// Where an unfinished picture waits: NAME.partial.exr, a picture for any viewer with the sums in further
/// channels.
[[nodiscard]] std::filesystem::path partial_path(const std::filesystem::path& path);

/// Renders to `path` (and half_paths). Deterministic: the same bits for any number of threads, and for a run
/// that was interrupted and resumed. Throws Error(wrong_arguments) for settings out of range,
/// Error(interrupted) after writing partial_path, Error(invalid_input) where that file is damaged or of other
/// settings, Error(out_of_memory), Error(cannot_write).
RenderResult render_to_file(const Scene& scene, const RenderSettings& settings,
                            const std::filesystem::path& path);

/// The same without files, interruption or resuming; for tests and benchmarks.
RenderResult render_picture(const Scene& scene, const RenderSettings& settings);

}  // namespace postlens
