// What a chart is asked to compare: one scene through one lens and one shutter.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lens/focus_geometry.h"
#include "tracer/camera_model.h"
#include "tracer/ray_scene.h"
#include "tracer/scene.h"

namespace postlens {

struct ChartRequest {
    std::filesystem::path scene;
    SceneReadOptions units;
    double exposure_stops = 0;   ///< of everything that is compared
    bool exposure_auto = false;  ///< instead: auto_exposure_stops
    CameraOverrides camera;
    std::string camera_name;  ///< empty: the scene's first

    std::optional<double> focal_length_mm;  ///< F of the lens; absent: the camera's film distance
    std::optional<double> f_number;   ///< absent: the camera's; infinity: a pinhole, for a shutter alone
    std::optional<double> focus_m;    ///< absent: the camera's
    std::optional<TimeSpan> shutter;  ///< absent: open for an instant

    /// Samples per pixel of each half of the reference.
    int reference_spp = 1024;
    /// A reference that is there already, and a second one of independent noise; absent: rendered.
    std::optional<std::filesystem::path> reference, second_reference;

    std::vector<int> spp{1, 4, 16, 64, 256, 1024};
    std::vector<int> views{16, 64, 256};
    std::vector<int> depths{8, 32, 128};
    /// Measured so often in turns; what takes longer than `once_above_s` is measured once.
    int rounds = 3;
    double once_above_s = 20;
    bool plots = true;  ///< SVG and PNG by gnuplot
};

/// Throws Error(wrong_arguments) for numbers out of range.
void check_chart_request(const ChartRequest& request);

}  // namespace postlens
