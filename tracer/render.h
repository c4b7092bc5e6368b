// `render` makes the reference image, with rays distributed over the lens and over time.
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
#include "pictures/image.h"
#include "scene/scene.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/sampling/sampler.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

struct RenderSettings {
    CameraOverrides camera;
    std::string camera_name;       ///< if empty, the first camera of the scene
    std::optional<double> time_s;  ///< instant if there is no shutter; if absent, that of the scene

    std::optional<double> focal_length_mm;  ///< focal length F; if absent, the film distance of the camera
    std::optional<double> f_number;  ///< if absent, that of the camera, or a pinhole if the camera has none
    std::optional<double> focus_m;   ///< if absent, that of the camera
    std::optional<std::pair<double, double>>
        focus_at;  ///< raster position, px, of the point in focus; replaces focus_m
    Framing framing = Framing::keep;
    std::shared_ptr<const Aperture> aperture;  ///< null: a disc
    /// A lens prescription (surfaces and glasses of a real lens), which replaces the thin lens.
    /// `focal_length_mm` must then be absent. Without `f_number`, the lens is wide open.
    std::shared_ptr<const Prescription> prescription;

    std::optional<TimeSpan> shutter;  ///< if absent, the exposure is an instant
    ShutterCurve curve = ShutterCurve::box();

    SamplerKind sampler = SamplerKind::sobol;
    int spp = 64;  ///< samples per pixel; must be even with `halves`
    std::uint64_t seed = 0;
    bool halves = false;  ///< also makes two images, from independent halves of the samples
    bool resume = false;  ///< continues an interrupted run
    DistributedSettings tracing;

    /// If set, only this part of the image is rendered, with the same bits as in the complete image. The
    /// image is rendered in tiles of 8 x 8 px, and tiles that lie outside this part stay black. A resumed run
    /// may use another crop.
    std::optional<Crop> crop;
    std::string made_by;  ///< written to the image files (Image::made_by)
    /// Text that marks each written file as one part of a render, to be merged (pictures/picture_part.h).
    /// If empty, the files are ordinary images.
    std::string part_mark;
    /// For program runs that share the samples of every pixel. If it is {i, n}, the samples are divided into
    /// n parts, and only part number i, from 0 to n - 1, is rendered.
    std::optional<std::array<int, 2>> sample_share;
};

struct RenderResult {
    Image image;
    std::array<Image, 2> halves;  ///< empty without `halves`
    RayCounts rays;               ///< numbers of rays of this run
    bool resumed = false;         ///< the run continued an interrupted one
    int spp_resumed = 0;        ///< least number of samples per pixel that the interrupted run had completed
    double seconds_render = 0;  ///< time of tracing alone, s
    double focal_length_mm = 0, f_number = 0, focus_m = 0;  ///< values used
    double motion_error_px = 0;  ///< greatest error, px, of the linear steps by which Embree moves meshes
};

/// Returns the number of blocks into which the `spp` samples of each pixel are divided. Several program runs
/// can share a render: each of the `shares` runs renders some of the blocks. If `halves` is true, the samples
/// form two independent halves, and each half is divided into this number of blocks.
/// Throws Error(wrong_arguments) if there are more runs than blocks.
[[nodiscard]] int sample_blocks(int shares, int spp, bool halves);

/// Returns the paths of the two images of independent halves of the samples, NAME.a.EXT and NAME.b.EXT.
[[nodiscard]] std::array<std::filesystem::path, 2> half_paths(const std::filesystem::path& path);
/// Returns the path of the file from which an interrupted render resumes, NAME.partial.exr.
/// Any viewer can display the image so far. Additional channels contain the sums of the samples.
[[nodiscard]] std::filesystem::path partial_path(const std::filesystem::path& path);

/// Renders the image to the file `path`. With RenderSettings::halves, also writes two images, each from an
/// independent half of the samples, to half_paths(path).
/// The files are bit-identical for any number of threads, and after any interruption and resumption.
/// Throws:
/// - Error(wrong_arguments) if a setting is out of range.
/// - Error(interrupted), after the state has been written to partial_path(path), from where a later run can
///   resume.
/// - Error(invalid_input) if the file to resume from is damaged or has other settings.
/// - Error(out_of_memory) or Error(cannot_write).
RenderResult render_to_file(const Scene& scene, const RenderSettings& settings,
                            const std::filesystem::path& path);

/// Renders into memory, without files and without resuming. Used by tests and benchmarks.
RenderResult render_picture(const Scene& scene, const RenderSettings& settings);

}  // namespace postlens
