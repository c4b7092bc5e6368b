// `trace`: a scene through a pinhole into a sample file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "records/sample_file.h"
#include "tracer/camera_model.h"
#include "tracer/corner_sampler.h"
#include "tracer/whitted.h"

namespace postlens {

struct TraceSettings {
    CameraOverrides camera;
    std::string camera_name;       ///< empty: the scene's first
    std::optional<double> time_s;  ///< absent: the scene's own
    SubdivisionSettings subdivision{.levels = 2};
    WhittedSettings whitted;
    int overscan_px = 0;
    bool overscan_auto = false;  ///< as wide as the lens range below asks for, found by a coarse trace first
    std::optional<double> for_f_number;
    std::optional<double> for_focus_m;
    RecordCompression compression = RecordCompression::zips;
    bool quiet = true;  ///< no progress bar
};

struct TraceResult {
    std::uint64_t records = 0;
    std::uint64_t bytes = 0;
    RayCounts rays;
    int overscan_px = 0;
};

/// Traces `scene` into a sample file at `path`; nothing appears there before all is done. Throws Error.
TraceResult trace_to_file(const Scene& scene, const TraceSettings& settings,
                          const std::filesystem::path& path);

/// The header that a trace with these settings writes; shared with tests and benchmarks.
[[nodiscard]] SampleHeader sample_header(const Scene& scene, const TraceSettings& settings,
                                         const CameraModel& camera, double time_s, int overscan_px);

/// What `trace` and `render` ask of a tree and of an instant. Throws Error(wrong_arguments).
void check_tracing(int max_depth, double min_contribution, const std::optional<double>& time_s);

/// The camera by name; the first for an empty name. Throws Error(wrong_arguments), naming those there are.
[[nodiscard]] const Camera& find_camera(const Scene& scene, const std::string& name);

}  // namespace postlens
