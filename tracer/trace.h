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
    /// If true and `for_f_number` is set, the edges of objects are subdivided to at least `lens_levels`
    /// levels. `subdivision.levels` then limits only the subdivision due to contrast.
    bool subdivide_for_lens = false;
    static constexpr int lens_levels = 3;
    /// Value of `subdivision.levels` for methods that also trace rays into the scene where the records are
    /// too coarse. docs/planner.md compares the times of other values.
    static constexpr int ray_levels = 1;
    /// Angle, degrees, by which an object may turn relative to the camera between two recorded instants. Used
    /// if `keys` is absent. A turning ball shows a strip of its surface that neither instant records. At 15
    /// degrees, the strip's width in the image is at most 0.9 % of the ball's radius (1 - cos 7.5 degrees).
    double degrees_per_key = 15;
    /// Value of `degrees_per_key` for methods that also trace rays into the scene.
    static constexpr double ray_degrees_per_key = 30;
    /// Target PSNR, in dB, of light that changes between two recorded instants (light_keys). Used if `keys`
    /// is absent. 43 dB use half of the squared error that 40 dB allow, the default target of the method
    /// auto.
    double light_db = 43;
    /// Value of `light_db` for methods that also trace rays into the scene. 12 dB less means four times the
    /// RMS error, which grows with the square of the time between instants if the light changes smoothly.
    /// Half as many instants then suffice.
    static constexpr double ray_light_db = 31;
    /// Width, px, up to which strips of hidden surfaces that a lens or motion reveals are not recorded.
    double narrow_strip_px = HiddenLayers::invisible_px;
    /// Value of `narrow_strip_px` for methods that also trace rays into the scene. Rays replace all samples
    /// within a leaf of an edge, which is half a pixel to a pixel wide on either side.
    static constexpr double ray_narrow_strip_px = 2;
    bool seek_small_things = true;  ///< subdivide at narrow objects (SmallThings), unless `levels` is 0
    /// trace_to_file sets `lens_radius_m` from the f-number of the lens: `for_f_number`, or that of the
    /// camera if absent, or 1.4 if both are absent. If `for_f_number` is given, `bend_radius_m`, the lens
    /// radius for measuring `w_bend`, gets the same value.
    WhittedSettings whitted;
    int overscan_px = 0;
    bool overscan_auto =
        false;  ///< find the overscan that the lens and shutter below need, by a coarse trace
    std::optional<double> for_f_number;
    std::optional<double> for_focus_m;
    std::optional<TimeSpan> for_shutter;
    /// Number of hidden surfaces recorded behind every visible one, 0 to 16. If absent, hidden surfaces are
    /// recorded if motion during `for_shutter` may reveal them or if a lens of `for_f_number` sees them past
    /// edges. If these two settings are absent too, no hidden surfaces are recorded.
    std::optional<int> hidden_layers;
    bool hidden_auto =
        false;  ///< `hidden_layers` is absent on purpose; requires `for_shutter` or `for_f_number`
    /// Number of evenly spaced instants of `for_shutter` that are recorded, 1 to 64. The frame's own instant
    /// is recorded too if it is not one of them. With 1, only the frame's instant is recorded. If absent, the
    /// number is chosen from the motion and the changing light of the scene, which requires `for_shutter`.
    std::optional<int> keys = 1;
    /// Automatic exposure, in stops, that is written to the file (tracer/exposure.h). If absent, no automatic
    /// exposure is written.
    std::optional<double> auto_exposure_stops;
    RecordCompression compression = RecordCompression::zips;
    std::string made_by;  ///< written to the file (SampleHeader::made_by)
    /// If set, only this share of the frame's rows is traced. The other rows of the file contain rays that
    /// hit nothing (trace_share.h).
    std::optional<Share> share;
    /// Called before the records are traced, with the predicted size of the file in bytes
    /// (tracer/recording/expected_size.h). An exception from this function ends the trace. If the function is
    /// empty, the size is not predicted.
    std::function<void(std::uint64_t bytes)> on_expected_bytes;
};

struct TraceResult {
    std::uint64_t records = 0;
    std::uint64_t bytes = 0;
    RayCounts rays;
    /// Number of narrow objects that rays may miss, because they may lie between all corners of cells. They
    /// are narrower than the smallest cells, or were omitted because there are too many. If cells are not
    /// subdivided, all narrow objects are counted.
    std::uint64_t too_narrow_objects = 0;
    int overscan_px = 0;
    int keys = 1;                    ///< number of evenly spaced recorded instants
    std::vector<double> instants_s;  ///< recorded instants; the frame's own is first
    /// Set if `keys` was chosen from the scene. `keys_sweep_degrees` is the angle by which an object or the
    /// camera turns, and `keys_reason` explains the chosen number.
    std::optional<double> keys_sweep_degrees;
    std::string keys_reason;
};

/// Throws Error(out_of_memory), with the size, if a lower bound of the memory that the trace needs exceeds
/// the available memory. trace_to_file makes the same check once it has found the overscan.
void require_trace_memory(const Scene& scene, const TraceSettings& settings,
                          const std::filesystem::path& path);

/// Traces the scene `placed` and writes a sample file to `path`. The file contains radiance, and the exposure
/// of the scene as a separate value. The file appears only when it is complete. Throws Error.
TraceResult trace_to_file(const Scene& placed, const TraceSettings& asked, const std::filesystem::path& path);

/// Returns the header that a trace with these settings writes if it records only the frame's own instant.
/// Also used by tests and benchmarks.
[[nodiscard]] SampleHeader sample_header(const Scene& scene, const TraceSettings& settings,
                                         const CameraModel& camera, double time_s, int overscan_px);

/// Checks settings of `trace` and `render`. Throws Error(wrong_arguments) if one is out of range.
void check_tracing(int max_depth, double min_contribution, const std::optional<double>& time_s);

/// Checks the shutter of `trace` or `render`. `option` is the name of the command-line option. Throws
/// Error(wrong_arguments).
void check_shutter(const char* option, const TimeSpan& shutter);

/// Returns the camera with this name, or the first camera if the name is empty. If there is no such camera,
/// throws Error(wrong_arguments) with a list of the existing names. Throws Error(invalid_input) if the scene
/// has no camera.
[[nodiscard]] const Camera& find_camera(const Scene& scene, const std::string& name);

}  // namespace postlens
