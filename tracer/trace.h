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
    std::string camera_name;       ///< if empty, the first camera of the scene
    std::optional<double> time_s;  ///< if absent, the scene's default instant
    SubdivisionSettings subdivision{.levels = 2};
    /// With a lens (`for_f_number`), pixels at object edges are divided at least `lens_levels` times. Then
    /// `subdivision.levels` limits only the division of pixels with contrast.
    bool subdivide_for_lens = false;
    static constexpr int lens_levels = 3;
    /// Used as `subdivision.levels` (depth of the quadtree of each pixel) for methods that trace further rays
    /// where these samples are too coarse. docs/planner.md compares the times for other values.
    static constexpr int ray_levels = 1;
    /// Largest angle, degrees, by which an object may turn relative to the camera from one recorded instant
    /// to the next. Used if `keys` is absent. With 15 degrees, the nearest recorded instant is at most 7.5
    /// degrees away. It misses a strip of a ball's surface that is 0.9 % of the radius wide (1 - cos 7.5
    /// degrees).
    double degrees_per_key = 15;
    /// Used as `degrees_per_key`, the turn between recorded instants, for methods that also trace rays. Rays
    /// show surfaces that the records lack, so fewer recorded instants suffice.
    static constexpr double ray_degrees_per_key = 30;
    /// Target PSNR, dB, of the error from changing light between recorded instants. Used if their number,
    /// `keys`, is absent. 43 dB is half the squared error of 40 dB, the default target of `auto`, so other
    /// errors may be as large.
    double light_db = 43;
    /// Used as `light_db`, the target PSNR for changing light, for methods that also trace rays. It is 12 dB
    /// lower, so that half as many recorded instants suffice.
    static constexpr double ray_light_db = 31;
    /// A hidden surface is not recorded if the lens or motion reveals only strips of it up to this width, px.
    double narrow_strip_px = HiddenLayers::invisible_px;
    /// Used as `narrow_strip_px`, the width of hidden strips that are not recorded, for methods that also
    /// trace rays. They trace rays up to 1 px beside edges anyway, so narrow records save none.
    static constexpr double ray_narrow_strip_px = 2;
    bool seek_small_things = true;  ///< subdivide at narrow objects (SmallThings), unless `levels` is 0
    /// Settings of the tracer. trace_to_file sets `lens_radius_m` from `for_f_number`, else from the camera's
    /// f-number, else from f/1.4. With `for_f_number`, it sets `bend_radius_m` to the same lens radius.
    WhittedSettings whitted;
    int overscan_px = 0;
    bool overscan_auto =
        false;  ///< find the overscan that the lens and shutter below need, by a coarse trace
    std::optional<double> for_f_number;
    std::optional<double> for_focus_m;
    std::optional<TimeSpan> for_shutter;
    /// Number of hidden surfaces recorded behind every visible one, 0 to 16. If absent, only those that
    /// `for_shutter` or `for_f_number` may reveal.
    std::optional<int> hidden_layers;
    bool hidden_auto =
        false;  ///< `hidden_layers` is absent on purpose; requires `for_shutter` or `for_f_number`
    /// Number of evenly spaced instants of `for_shutter` that are recorded, 1 to 64. With 1, only the frame's
    /// own instant, `time_s`, is recorded. If absent, the number is chosen from the motion and the changing
    /// light.
    std::optional<int> keys = 1;
    /// Automatic exposure, in stops, to write to the file (tracer/exposure.h). If absent, none is written.
    std::optional<double> auto_exposure_stops;
    RecordCompression compression = RecordCompression::zips;
    std::string made_by;  ///< written to the file (SampleHeader::made_by)
    /// If set, only this share of the rows is traced (trace_share.h). All other rows are recorded as empty.
    std::optional<Share> share;
    /// If set, called before the trace with the predicted size of the file in bytes (expected_size.h).
    /// An exception from this function ends the trace.
    std::function<void(std::uint64_t bytes)> on_expected_bytes;
};

struct TraceResult {
    std::uint64_t records = 0;
    std::uint64_t bytes = 0;
    RayCounts rays;
    /// Number of objects that eye rays may miss. They are narrower than the smallest quadtree cells, or the
    /// limited number of cells does not suffice for them.
    /// Without subdivision, counts all objects narrower than 1.5 px.
    std::uint64_t too_narrow_objects = 0;
    int overscan_px = 0;
    int keys = 1;                    ///< number of evenly spaced recorded instants
    std::vector<double> instants_s;  ///< recorded instants; the frame's own is first
    /// Only if `keys` is chosen automatically: the largest turn, degrees, of an object or the camera during
    /// the shutter, and the reason for this number of recorded instants.
    std::optional<double> keys_sweep_degrees;
    std::string keys_reason;
};

/// Throws Error(out_of_memory), which states the needed size, if a trace certainly needs more memory than
/// available. trace_to_file repeats this check when it knows the overscan, whose records need memory too.
void require_trace_memory(const Scene& scene, const TraceSettings& settings,
                          const std::filesystem::path& path);

/// Traces a scene and writes a sample file to `path`, which appears only when it is complete.
/// The scene's exposure is stored separately from the radiance. Throws Error.
TraceResult trace_to_file(const Scene& placed, const TraceSettings& asked, const std::filesystem::path& path);

/// Returns the header of a sample file whose records show only one instant, that of the frame, instead of
/// several instants of the shutter interval.
[[nodiscard]] SampleHeader sample_header(const Scene& scene, const TraceSettings& settings,
                                         const CameraModel& camera, double time_s, int overscan_px);

/// Checks settings of `trace` and `render`. Throws Error(wrong_arguments) if one is out of range.
void check_tracing(int max_depth, double min_contribution, const std::optional<double>& time_s);

/// Throws Error(wrong_arguments) if the shutter of `trace` or `render` is not finite or closes before it
/// opens. `option` is the name of the command-line option.
void check_shutter(const char* option, const TimeSpan& shutter);

/// Returns the camera with this name, or the first camera if the name is empty.
/// Throws Error(wrong_arguments) with the existing names if there is no such camera.
/// Throws Error(invalid_input) if the scene has no camera.
[[nodiscard]] const Camera& find_camera(const Scene& scene, const std::string& name);

}  // namespace postlens
