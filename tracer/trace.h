// `trace` traces a scene through a pinhole and writes a sample file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "core/share.h"
#include "records/sample_file.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

struct TraceSettings {
    CameraOverrides camera;
    std::string camera_name;       ///< empty: the scene's first
    std::optional<double> time_s;  ///< empty: the scene's
    SubdivisionSettings subdivision{.levels = 2};
    /// With `for_f_number`: cells at the edges of objects are subdivided to at least `lens_levels`.
    /// `subdivision.levels` then limits only subdivision by contrast.
    bool subdivide_for_lens = false;
    static constexpr int lens_levels = 3;
    /// Levels of subdivision that suffice if rays into the scene replace the view samples that coarse records
    /// do not determine (docs/planner.md has the times of other levels).
    static constexpr int ray_levels = 1;
    /// Angle, degrees, by which an object turns relative to the camera between two recorded instants, if
    /// `keys` is absent. Halfway between two recorded instants, a ball has turned by 7.5 degrees
    /// from either. The strip along its silhouette that neither instant shows is then 1 - cos 7.5 degrees, or
    /// 0.9 %, of its radius wide.
    double degrees_per_key = 15;
    /// Angle that suffices if rays into the scene replace samples of views. In motion.toml, which turns a box
    /// by 65 degrees, keys at 15, 30 and 33 degrees give equally accurate images.
    static constexpr double ray_degrees_per_key = 30;
    /// PSNR of the light that changes between two recorded instants (light_keys), dB, if `keys` is absent:
    /// half of the squared error of an image of 40 dB.
    double light_db = 43;
    /// PSNR that suffices for images with rays in the scene: of a smooth change, half as many keys have four
    /// times the error, 12 dB.
    static constexpr double ray_light_db = 31;
    bool seek_small_things = true;  ///< subdivide at narrow objects (SmallThings), unless `levels` is 0
    /// trace_to_file replaces two radii. With `for_f_number`, both become the radius of that lens. Otherwise
    /// `lens_radius_m` becomes the radius of the camera's lens, or of a lens of f/1.4 if the camera has no
    /// f-number, and `bend_radius_m` is kept.
    WhittedSettings whitted;
    int overscan_px = 0;
    bool overscan_auto =
        false;  ///< find the overscan that the lens and shutter below need, by a coarse trace
    std::optional<double> for_f_number;
    std::optional<double> for_focus_m;
    std::optional<TimeSpan> for_shutter;
    /// Number of hidden surfaces recorded behind every visible one, 0 to 16. If absent, two kinds of surfaces
    /// are recorded: those that motion during `for_shutter` may reveal, and those that a lens of
    /// `for_f_number` sees past edges. None are recorded if both options are absent.
    std::optional<int> hidden_layers;
    bool hidden_auto =
        false;  ///< `hidden_layers` is absent on purpose; requires `for_shutter` or `for_f_number`
    /// Number of evenly spaced instants of `for_shutter` that are recorded, 1 to 64. The frame's instant is
    /// added if it is not one of them. 1: only the frame's instant. If absent: as many as the motion needs,
    /// which requires `for_shutter`.
    std::optional<int> keys = 1;
    /// Automatic exposure, stops, that is written to the file (tracer/exposure.h). If absent, the file
    /// contains none.
    std::optional<double> auto_exposure_stops;
    RecordCompression compression = RecordCompression::zips;
    std::string made_by;  ///< for the file (SampleHeader::made_by)
    /// Traces only some rows. In the file, the rays of all other rows hit nothing (trace_share.h).
    std::optional<Share> share;
    /// Function that is called before the records are traced, with the approximate size of the file in bytes
    /// (tracer/recording/expected_size.h). An exception from it ends the trace. If empty, the size is not
    /// predicted.
    std::function<void(std::uint64_t bytes)> on_expected_bytes;
};

struct TraceResult {
    std::uint64_t records = 0;
    std::uint64_t bytes = 0;
    RayCounts rays;
    /// Number of narrow objects that all corners may miss: objects narrower than the smallest cells, and
    /// objects omitted because of the limit of cells. If cells are not subdivided, these are all narrow
    /// objects.
    std::uint64_t too_narrow_objects = 0;
    int overscan_px = 0;
    int keys = 1;                    ///< as in the settings, or as the motion needs
    std::vector<double> instants_s;  ///< recorded instants; the frame's own is first
    /// Set if `keys` was chosen from the scene: the angle by which an object or the camera turns, and what
    /// determines the number.
    std::optional<double> keys_sweep_degrees;
    std::string keys_reason;
};

/// Throws Error(out_of_memory), with the size, if a lower bound of the trace's memory exceeds the available
/// memory. trace_to_file checks this too, with the overscan that it has found.
void require_trace_memory(const Scene& scene, const TraceSettings& settings,
                          const std::filesystem::path& path);

/// Traces the scene `placed` and writes a sample file to `path`. The file contains radiance, and the exposure
/// of the scene. It appears only when it is complete. Throws Error.
TraceResult trace_to_file(const Scene& placed, const TraceSettings& asked, const std::filesystem::path& path);

/// Returns the header that a trace with these settings writes, except for recorded instants (keys) other than
/// the frame's. Tests and benchmarks use it too.
[[nodiscard]] SampleHeader sample_header(const Scene& scene, const TraceSettings& settings,
                                         const CameraModel& camera, double time_s, int overscan_px);

/// Checks settings of `trace` and `render`. Throws Error(wrong_arguments) if one is out of range.
void check_tracing(int max_depth, double min_contribution, const std::optional<double>& time_s);

/// Checks a shutter of `trace` or `render`; `option` is the name of its option. Throws
/// Error(wrong_arguments).
void check_shutter(const char* option, const TimeSpan& shutter);

/// Returns the camera with this name, or the first camera if the name is empty. Throws Error(wrong_arguments)
/// with a list of the existing names.
[[nodiscard]] const Camera& find_camera(const Scene& scene, const std::string& name);

}  // namespace postlens
