// `trace`: a scene through a pinhole into a sample file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "records/sample_file.h"
#include "tracer/camera_model.h"
#include "tracer/corner_sampler.h"
#include "tracer/ray_scene.h"
#include "tracer/whitted.h"

namespace postlens {

struct TraceSettings {
    CameraOverrides camera;
    std::string camera_name;       ///< empty: the scene's first
    std::optional<double> time_s;  ///< absent: the scene's own
    SubdivisionSettings subdivision{.levels = 2};
    /// With `for_f_number`: at least as many levels as `lens_levels` at the edges of objects, in place of
    /// `subdivision.levels`, which then holds for colours.
    bool subdivide_for_lens = false;
    static constexpr int lens_levels = 3;
    bool seek_small_things = true;  ///< see SmallThings; where something is subdivided at all
    /// `bend_radius_m` and `lens_radius_m` are set by trace_to_file: of `for_f_number`, else of the camera,
    /// else f/1.4.
    WhittedSettings whitted;
    int overscan_px = 0;
    bool overscan_auto = false;  ///< as wide as lens and shutter below ask for, found by a coarse trace first
    std::optional<double> for_f_number;
    std::optional<double> for_focus_m;
    std::optional<TimeSpan> for_shutter;
    /// Hidden surfaces, 0 to 16: so many behind every visible one. Absent: those that `for_shutter` may bring
    /// to light and those that a lens of `for_f_number` sees past the edges of others; none without both.
    std::optional<int> hidden_layers;
    bool hidden_auto = false;  ///< `hidden_layers` left absent on purpose: needs one of the two
    /// How many instants of `for_shutter`, 1 to 64, evenly spread; the frame's own comes in addition where it
    /// is none of them, and alone for 1. Absent: as many as the motion asks for, which needs `for_shutter`.
    std::optional<int> keys = 1;
    /// Kept in the file (tracer/exposure.h); absent: the file does not say.
    std::optional<double> auto_exposure_stops;
    RecordCompression compression = RecordCompression::zips;
    /// Told, before the records are traced, how many bytes the file will take about (expected_size.h); what
    /// it throws ends the trace. Absent: nobody asks, and no ray is spent on it.
    std::function<void(std::uint64_t bytes)> on_expected_bytes;
};

struct TraceResult {
    std::uint64_t records = 0;
    std::uint64_t bytes = 0;
    RayCounts rays;
    /// Objects narrower than the smallest cells, or too many, or all narrow ones without subdivision: corners
    /// may miss them.
    std::uint64_t too_narrow_objects = 0;
    int overscan_px = 0;
    int keys = 1;                              ///< as asked for, or chosen
    std::vector<double> instants_s;            ///< recorded: the frame's own, then the others
    std::optional<double> keys_sweep_degrees;  ///< where the motion chose `keys`: view_sweep_degrees
};

/// Throws Error(out_of_memory), saying how much it takes, where memory cannot hold what a trace of this size
/// holds at least. trace_to_file asks as well, with the overscan it finds.
void require_trace_memory(const Scene& scene, const TraceSettings& settings,
                          const std::filesystem::path& path);

/// Traces `scene` into a sample file at `path`, which holds radiance and the scene's exposure; nothing
/// appears there before all is done. Throws Error.
TraceResult trace_to_file(const Scene& scene, const TraceSettings& asked, const std::filesystem::path& path);

/// The header that a trace with these settings writes, without keys; shared with tests and benchmarks.
[[nodiscard]] SampleHeader sample_header(const Scene& scene, const TraceSettings& settings,
                                         const CameraModel& camera, double time_s, int overscan_px);

/// What `trace` and `render` ask of a tree and of an instant. Throws Error(wrong_arguments).
void check_tracing(int max_depth, double min_contribution, const std::optional<double>& time_s);

/// What `trace` and `render` ask of a shutter, which `option` names. Throws Error(wrong_arguments).
void check_shutter(const char* option, const TimeSpan& shutter);

/// The camera by name; the first for an empty name. Throws Error(wrong_arguments), naming those there are.
[[nodiscard]] const Camera& find_camera(const Scene& scene, const std::string& name);

}  // namespace postlens
