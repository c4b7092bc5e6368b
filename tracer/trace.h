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
    /// If true and a lens is given (`for_f_number`), pixels at the edges of objects are divided into quarters
    /// at least `lens_levels` times, even if `subdivision.levels` is smaller. Inside objects, where pixels
    /// are divided only because of their colours' contrast, `subdivision.levels` remains the limit.
    bool subdivide_for_lens = false;
    static constexpr int lens_levels = 3;
    /// The value of `subdivision.levels`, i.e. how often a pixel may be divided into quarters, for methods
    /// that also trace rays when they make an image. A small value suffices for these methods, because they
    /// trace rays wherever the recorded samples are too far apart. docs/planner.md compares the times for
    /// other values.
    static constexpr int ray_levels = 1;
    /// Greatest angle, degrees, by which an object may turn relative to the camera from one recorded instant
    /// to the next. It determines the number of recorded instants if `keys` is absent. By turning, an object
    /// shows surface that was not recorded. With 15 degrees, every instant is within 7.5 degrees of a
    /// recorded one. Then a ball shows, at its outline, an unrecorded strip of only 0.9 % of its radius (1 -
    /// cos 7.5 degrees).
    double degrees_per_key = 15;
    /// The value of `degrees_per_key` for methods that also trace rays when they make an image. It is the
    /// greatest angle, degrees, by which an object may turn relative to the camera between two recorded
    /// instants. It is greater than for other methods, because rays show the surfaces that no recorded
    /// instant contains.
    static constexpr double ray_degrees_per_key = 30;
    /// Least PSNR, dB, with respect to one error: light changes between recorded instants, where it is
    /// interpolated. If the number of recorded instants (`keys`) is absent, it is chosen so that this PSNR is
    /// reached. By default, the method `auto` makes images with 40 dB in total. An error at 43 dB has half
    /// the squared error of 40 dB, so the other half remains for all other errors.
    double light_db = 43;
    /// The value of `light_db` for methods that also trace rays when they make an image. `light_db` limits
    /// the error that arises because the light changes between recorded instants. It is the least accepted
    /// PSNR, dB, and here it is 12 dB lower than for other methods. So about half as many recorded instants
    /// suffice: with twice the distance between them, the error of linear interpolation is about four times
    /// as large, i.e. 12 dB.
    static constexpr double ray_light_db = 31;
    /// A hidden surface is recorded only if the lens or motion reveals a strip of it that is wider than this,
    /// px. Such a strip appears beside the edge of a nearer object when the lens point or the instant
    /// changes.
    double narrow_strip_px = HiddenLayers::invisible_px;
    /// The value of `narrow_strip_px` for methods that also trace rays when they make an image. A hidden
    /// surface is not recorded if the lens or motion reveals only a strip of it that is at most this wide,
    /// px. These methods trace rays anyway within 1 px of the edge beside which the strip lies. So a record
    /// of a narrow strip would save no rays.
    static constexpr double ray_narrow_strip_px = 2;
    bool seek_small_things = true;  ///< subdivide at narrow objects (SmallThings), unless `levels` is 0
    /// Settings of the tracer. Two of them are set by trace_to_file. `lens_radius_m`, the radius of the lens,
    /// follows from `for_f_number`. If `for_f_number` is absent, the f-number is that of the camera, or else
    /// 1.4. If `for_f_number` is given, `bend_radius_m` is set to the same radius. Then the tracer measures
    /// how nonlinearly mirror images move when the lens point moves over this lens.
    WhittedSettings whitted;
    int overscan_px = 0;
    bool overscan_auto =
        false;  ///< find the overscan that the lens and shutter below need, by a coarse trace
    std::optional<double> for_f_number;
    std::optional<double> for_focus_m;
    std::optional<TimeSpan> for_shutter;
    /// Number of hidden surfaces, 0 to 16, that are recorded behind every visible surface. If it is absent,
    /// only hidden surfaces that may become visible are recorded: during the exposure `for_shutter`, or from
    /// a point of the lens whose f-number is `for_f_number`.
    std::optional<int> hidden_layers;
    bool hidden_auto =
        false;  ///< `hidden_layers` is absent on purpose; requires `for_shutter` or `for_f_number`
    /// Number of recorded instants, 1 to 64, evenly spaced over the interval `for_shutter`. If the number is
    /// 1, only the frame's own instant, `time_s`, is recorded. If no number is given, one is chosen from the
    /// motion and the changes of the light.
    std::optional<int> keys = 1;
    /// Exposure correction, in stops, that was found automatically (tracer/exposure.h). It is written to the
    /// sample file. If absent, none is written.
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
    /// Number of narrow objects that may be missing in the file, because all eye rays may miss them. Eye rays
    /// pass through the corners of quadtree cells. Such an object is narrower than the smallest cells, or the
    /// limited number of cells did not suffice for it. If pixels are not subdivided, all objects narrower
    /// than 1.5 px are counted.
    std::uint64_t too_narrow_objects = 0;
    int overscan_px = 0;
    int keys = 1;                    ///< number of evenly spaced recorded instants
    std::vector<double> instants_s;  ///< recorded instants; the frame's own is first
    /// Two results that are set only if the number of recorded instants, `keys`, is chosen automatically: the
    /// greatest angle, degrees, by which an object or the camera turns during the shutter interval, and a
    /// text for the user that explains the number.
    std::optional<double> keys_sweep_degrees;
    std::string keys_reason;
};

/// Throws Error(out_of_memory), which states the needed size, if a trace certainly needs more memory than is
/// available. The overscan (the traced border around the frame) also needs memory, but its width may not be
/// known yet. So trace_to_file repeats this check when it knows the width.
void require_trace_memory(const Scene& scene, const TraceSettings& settings,
                          const std::filesystem::path& path);

/// Traces a scene and writes a sample file to `path`, which appears only when it is complete.
/// The scene's exposure is stored separately from the radiance. Throws Error.
TraceResult trace_to_file(const Scene& placed, const TraceSettings& asked, const std::filesystem::path& path);

/// Returns the header of a sample file that records a single instant, `time_s`, which is that of the frame.
/// `overscan_px` is the width of the traced border around the frame.
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
