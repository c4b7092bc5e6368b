// Settings of a chart, which compares methods for one scene with one lens and one shutter.
#pragma once

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

struct ChartRequest {
    std::filesystem::path scene;
    SceneReadOptions units;
    double exposure_stops = 0;   ///< exposure of all compared images
    bool exposure_auto = false;  ///< uses auto_exposure_stops instead of exposure_stops
    CameraOverrides camera;
    std::string camera_name;  ///< empty: the scene's first camera

    std::optional<double> focal_length_mm;  ///< absent: the camera's film distance
    std::optional<double> f_number;         ///< absent: the camera's; infinite: a pinhole
    std::optional<double> focus_m;          ///< absent: the camera's
    std::optional<TimeSpan> shutter;        ///< absent: no motion blur

    /// Samples per pixel of each half of the reference.
    int reference_spp = 1024;
    /// Files of an existing reference and of a second one with independent noise. Absent: both are rendered.
    std::optional<std::filesystem::path> reference, second_reference;

    std::vector<int> spp{1, 4, 16, 64, 256, 1024};
    std::vector<int> views{16, 64, 256};
    std::vector<int> depths{8, 32, 128};
    /// Each round measures every point once. A point that takes more than `once_above_s` is measured in the
    /// first round only.
    int rounds = 3;
    double once_above_s = 20;
    bool plots = true;  ///< draw SVG and PNG plots with gnuplot

    /// Measures only every N-th point of the plan, into chart.I-of-N.json. A later chart of all points in the
    /// same folder takes over what the shares have measured.
    std::optional<Share> share;
    std::string part;      ///< JSON that the chart of a share states as "part"; empty: none
    Join join = Join::no;  ///< measures no point
};

/// Throws Error(wrong_arguments) for a number out of range, and for a second reference without a first.
void check_chart_request(const ChartRequest& request);

}  // namespace postlens
