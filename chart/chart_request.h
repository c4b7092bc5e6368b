// Settings of a chart, which compares methods for one scene, lens and shutter.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/share.h"
#include "lens/focus_geometry.h"
#include "scene/scene.h"
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"

namespace postlens {

/// Seed of the ray-traced references. It makes charts repeatable.
inline constexpr std::uint64_t reference_seed = 1;

struct ChartRequest {
    std::filesystem::path scene;
    SceneReadOptions units;
    double exposure_stops = 0;   ///< exposure of all compared images
    bool exposure_auto = false;  ///< uses auto_exposure_stops instead of exposure_stops
    CameraOverrides camera;
    std::string camera_name;  ///< if empty, the first camera of the scene

    std::optional<double> focal_length_mm;  ///< if absent, the camera's film distance
    std::optional<double> f_number;         ///< if absent, that of the camera; infinite for a pinhole
    std::optional<double> focus_m;          ///< if absent, that of the camera
    std::optional<TimeSpan> shutter;        ///< if absent, there is no motion blur

    /// Samples per pixel of each half of the reference.
    int reference_spp = 1024;
    /// Files of an existing reference image, and of a second one with independent noise. If `reference` is
    /// absent, two are rendered.
    std::optional<std::filesystem::path> reference, second_reference;

    std::vector<int> spp{1, 4, 16, 64, 256, 1024};
    std::vector<int> views{16, 64, 256};
    std::vector<int> depths{8, 32, 128};
    /// Each round times every method and setting once. Those slower than `once_above_s` seconds are timed
    /// only in the first round.
    int rounds = 3;
    double once_above_s = 20;
    bool plots = true;  ///< draw SVG and PNG plots with gnuplot

    /// Share of this machine, if N machines divide the measurements of a chart. Machine I measures every N-th
    /// point (method with its settings), and writes chart.I-of-N.json. Afterwards, a run without a share in
    /// the same folder makes the chart from these files.
    std::optional<Share> share;
    std::string part;      ///< JSON that the chart of a share stores under the key "part"; may be empty
    Join join = Join::no;  ///< if not `no`, no point is measured
};

/// Throws Error(wrong_arguments) if a number is out of range, or if `second_reference` is set without
/// `reference`.
void check_chart_request(const ChartRequest& request);

}  // namespace postlens
