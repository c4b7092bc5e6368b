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
    /// If a lens is given (`for_f_number`) and this is true, pixels at the edges of objects are divided at
    /// least `lens_levels` times. Then `subdivision.levels`, the depth of the pixels' quadtrees, limits only
    /// the division of pixels with contrast.
    bool subdivide_for_lens = false;
    static constexpr int lens_levels = 3;
    /// The depth of the quadtree of each pixel (`subdivision.levels`) for methods that also trace rays when
    /// they make the image. They trace rays where the samples of the file are too coarse. docs/planner.md
    /// compares the times for other values.
    static constexpr int ray_levels = 1;
    /// Largest angle, degrees, by which an object may turn relative to the camera from one recorded instant
    /// to the next. It determines the number of recorded instants if `keys` is absent. With 15 degrees, an
    /// object at any instant is turned by at most 7.5 degrees relative to the nearest recorded instant. Of a
    /// ball, the records of that instant then lack a strip of the surface, whose width is only 0.9 % of the
    /// radius (one minus the cosine of 7.5 degrees).
    double degrees_per_key = 15;
    /// Largest turn, degrees, between two recorded instants (`degrees_per_key`), for methods that also trace
    /// rays when they make the image. These rays show surfaces that the records lack, so fewer recorded
    /// instants suffice for them.
    static constexpr double ray_degrees_per_key = 30;
    /// Target PSNR, dB, for the error that arises because the light changes between recorded instants. It
    /// determines the number of these instants if `keys` is absent. The default target of `auto` for the
    /// whole error is 40 dB. With 43 dB, this part has half the squared error of 40 dB, which leaves the
    /// other half for all other errors.
    double light_db = 43;
    /// Target PSNR, dB, for light that changes between recorded instants (`light_db`), for methods that also
    /// trace rays. It is 12 dB less than the value for other methods. With half as many recorded instants,
    /// the error of linear interpolation between them is about four times as large, i.e. 12 dB. So about half
    /// as many instants suffice.
    static constexpr double ray_light_db = 31;
    /// A hidden surface is not recorded if the lens or motion reveals only strips of it, beside the edges of
    /// objects, that are at most this wide, px.
    double narrow_strip_px = HiddenLayers::invisible_px;
    /// Largest width, px, of strips of hidden surfaces that are not recorded (`narrow_strip_px`), for methods
    /// that also trace rays when they make the image. These methods trace rays up to 1 px beside edges
    /// anyway, so records of narrow strips would not save rays.
    static constexpr double ray_narrow_strip_px = 2;
    bool seek_small_things = true;  ///< subdivide at narrow objects (SmallThings), unless `levels` is 0
    /// Settings of the tracer. trace_to_file sets `lens_radius_m`, the radius of the lens, from
    /// `for_f_number`. If this is absent, it uses the camera's f-number, or else f/1.4. With `for_f_number`,
    /// it also sets `bend_radius_m` to this radius, so that the nonlinear motion of mirror images over the
    /// lens is measured.
    WhittedSettings whitted;
    int overscan_px = 0;
    bool overscan_auto =
        false;  ///< find the overscan that the lens and shutter below need, by a coarse trace
    std::optional<double> for_f_number;
    std::optional<double> for_focus_m;
    std::optional<TimeSpan> for_shutter;
    /// Number of hidden surfaces, 0 to 16, that are recorded behind every visible surface. If it is absent,
    /// only those hidden surfaces are recorded that the shutter `for_shutter` or the lens `for_f_number` may
    /// reveal.
    std::optional<int> hidden_layers;
    bool hidden_auto =
        false;  ///< `hidden_layers` is absent on purpose; requires `for_shutter` or `for_f_number`
    /// Number of recorded instants, 1 to 64. They are evenly spaced over the interval `for_shutter`. If the
    /// number is 1, only the frame's own instant, `time_s`, is recorded. If it is absent, it is chosen from
    /// the motion and the changes of the light.
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
    /// Number of objects that eye rays may miss. Such objects are narrower than the smallest quadtree cells,
    /// or the limited number of cells does not suffice for them. If pixels are not subdivided, all objects
    /// narrower than 1.5 px are counted.
    std::uint64_t too_narrow_objects = 0;
    int overscan_px = 0;
    int keys = 1;                    ///< number of evenly spaced recorded instants
    std::vector<double> instants_s;  ///< recorded instants; the frame's own is first
    /// The largest angle, degrees, by which an object or the camera turns during the shutter interval, and
    /// the text that says why this number of instants, `keys`, is recorded. Both are set only if the number
    /// is chosen automatically.
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
