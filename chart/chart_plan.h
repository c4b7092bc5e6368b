// The plan of a chart, which compares the errors and times of several methods. It lists the sample files to
// trace, and the methods to run.
#pragma once

#include <string>
#include <vector>

#include "chart/chart_request.h"
#include "focus/focus.h"
#include "motionblur/motion_blur.h"
#include "scene/scene.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace postlens {

/// Lens, shutter and camera with which all images of a chart are made. Values that the ChartRequest does not
/// contain come from the scene.
struct ChartView {
    ThinLens lens;  ///< f_number is infinite for a pinhole
    double focus_m = 1;
    std::optional<TimeSpan> shutter;
    double film_distance_mm = 0;
    int width = 0, height = 0;
    double time_s = 0;
    [[nodiscard]] bool has_lens() const;
    /// Returns the f-number for which a sample file must be traced for this lens. The definitions differ: the
    /// sample file's f-number is film distance / lens diameter, but the f-number in `lens` is focal length /
    /// lens diameter. So the value is converted.
    [[nodiscard]] double traced_f_number() const;
};

struct PlannedTrace {
    std::string name;
    TraceSettings settings;
};

/// One point of the chart: a method and its settings.
struct PlannedPoint {
    enum class Kind { focus, motionblur, shoot, rays };
    Kind kind = Kind::focus;
    std::string curve, name, trace;
    int amount = 0;
    FocusMethod focus = FocusMethod::scatter;  ///< used by Kind::focus and Kind::shoot
    MotionMethod motion = MotionMethod::automatic;
};

struct ChartPlan {
    std::vector<PlannedTrace> traces;
    std::vector<PlannedPoint> points;
};

/// Returns the lens, the shutter and the camera for which a chart compares the errors and times of several
/// methods. Throws Error(wrong_arguments) if the lens is not defined. Also throws it if nothing would be
/// blurred, that is, if the f-number is infinite and there is no shutter.
[[nodiscard]] ChartView chart_view(const ChartRequest& request, const Scene& scene);

/// Returns settings for tracing the most complete sample file of a chart. It contains every surface that is
/// visible from the lens while the shutter is open.
[[nodiscard]] TraceSettings best_trace(const ChartRequest& request, const ChartView& view);

[[nodiscard]] ChartPlan chart_plan(const ChartRequest& request, const ChartView& view);

/// Returns settings with which `render` makes the reference image of a chart (comparison of methods) by
/// distributed ray tracing. The caller must add the number of samples per pixel (`spp`), the seed, and
/// `halves`, by which two images are also made from independent halves of the samples.
[[nodiscard]] RenderSettings render_settings(const ChartRequest& request, const ChartView& view);

}  // namespace postlens
