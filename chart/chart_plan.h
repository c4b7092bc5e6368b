// What a chart measures: sample files, and methods with their settings.
#pragma once

#include <string>
#include <vector>

#include "chart/chart_request.h"
#include "focus/focus.h"
#include "motionblur/motion_blur.h"
#include "tracer/render.h"
#include "tracer/scene.h"
#include "tracer/trace.h"

namespace postlens {

/// The request with everything that the scene decides filled in.
struct ChartView {
    ThinLens lens;  ///< f_number infinity: a pinhole
    double focus_m = 1;
    std::optional<TimeSpan> shutter;
    double film_distance_mm = 0;
    int width = 0, height = 0;
    double time_s = 0;
    [[nodiscard]] bool has_lens() const;
    /// The trace knows the lens by its diameter at the film distance of the view.
    [[nodiscard]] double traced_f_number() const;
};

struct PlannedTrace {
    std::string name;
    TraceSettings settings;
};

/// One point of the chart: how its picture is made.
struct PlannedPoint {
    enum class Kind { focus, motionblur, shoot, rays };
    Kind kind = Kind::focus;
    std::string curve, name, trace;
    int amount = 0;
    FocusMethod focus = FocusMethod::scatter;  ///< focus and shoot
    MotionMethod motion = MotionMethod::automatic;
};

struct ChartPlan {
    std::vector<PlannedTrace> traces;
    std::vector<PlannedPoint> points;
};

/// Throws Error(wrong_arguments) where neither request nor scene says what the lens is, or where neither lens
/// nor shutter blurs anything.
[[nodiscard]] ChartView chart_view(const ChartRequest& request, const Scene& scene);

/// A trace that records all that lens and shutter of this view may bring to light.
[[nodiscard]] TraceSettings best_trace(const ChartRequest& request, const ChartView& view);

[[nodiscard]] ChartPlan chart_plan(const ChartRequest& request, const ChartView& view);

/// Rays of this view; spp, seed and halves are the caller's.
[[nodiscard]] RenderSettings render_settings(const ChartRequest& request, const ChartView& view);

}  // namespace postlens
