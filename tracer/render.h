// `render` makes an image by rays that are distributed over lens and time. This image is the reference for
// post-processed images.
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
    std::string camera_name;       ///< empty: the scene's first
    std::optional<double> time_s;  ///< instant if there is no shutter; if absent, that of the scene

    std::optional<double> focal_length_mm;  ///< focal length F; if absent, the film distance of the camera
    std::optional<double> f_number;  ///< if absent, that of the camera, or a pinhole if the camera has none
    std::optional<double> focus_m;   ///< empty: the camera's
    std::optional<std::pair<double, double>>
        focus_at;  ///< raster position, px, of the point in focus; replaces focus_m
    Framing framing = Framing::keep;
    std::shared_ptr<const Aperture> aperture;  ///< null: a disc
    /// A lens prescription, used instead of a thin lens. `focal_length_mm` must then be absent. Without
    /// `f_number`, the lens is wide open.
    std::shared_ptr<const Prescription> prescription;

    std::optional<TimeSpan> shutter;  ///< empty: the exposure is an instant
    ShutterCurve curve = ShutterCurve::box();

    SamplerKind sampler = SamplerKind::sobol;
    int spp = 64;  ///< samples per pixel; must be even with `halves`
    std::uint64_t seed = 0;
    bool halves = false;  ///< also makes two images, from independent halves of the samples
    bool resume = false;  ///< continues an interrupted run
    DistributedSettings tracing;

    /// The crop of the image that is rendered. Tiles of 8 px outside the crop stay black. The other tiles are
    /// bit-identical to those without a crop. Files contain only the crop (see write_image). A run may be
    /// resumed with another crop.
    std::optional<Crop> crop;
    std::string made_by;  ///< for the files of the pictures (Image::made_by)
    /// text stored in each file, which is then a part of a render (records/picture_part.h); if empty, the
    /// files are images
    std::string part_mark;
    /// With `part_mark`: the file contains some of the samples of every pixel, part `sample_share[0]` of
    /// `sample_share[1]` (render_state.h). Separate files for the two halves of the samples are not written.
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

/// Returns the number of blocks into which the samples of a pixel are divided. Each of `shares` parts of a
/// render consists of some blocks (distributed/render_state.h). Throws Error(wrong_arguments) if there are
/// more parts than blocks.
[[nodiscard]] int sample_blocks(int shares, int spp, bool halves);

/// Paths of the two files of `halves`: NAME.a.EXT and NAME.b.EXT.
[[nodiscard]] std::array<std::filesystem::path, 2> half_paths(const std::filesystem::path& path);
/// Returns the path of an unfinished image: NAME.partial.exr. Any viewer can display it. Additional channels
/// contain the sums.
[[nodiscard]] std::filesystem::path partial_path(const std::filesystem::path& path);

/// Renders to the file `path`, and to half_paths. The file is bit-identical for any number of threads, and
/// for a run that was interrupted and resumed. Throws Error(wrong_arguments) for settings out of range,
/// Error(interrupted) after writing partial_path, Error(invalid_input) if that file is damaged or has other
/// settings, Error(out_of_memory), and Error(cannot_write).
RenderResult render_to_file(const Scene& scene, const RenderSettings& settings,
                            const std::filesystem::path& path);

/// Renders into memory, without files and without resuming; for tests and benchmarks.
RenderResult render_picture(const Scene& scene, const RenderSettings& settings);

}  // namespace postlens
