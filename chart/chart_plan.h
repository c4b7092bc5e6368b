// The plan of a chart. It lists the sample files to trace and the methods to run, with their settings.
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

/// Lens, shutter and camera of a chart. Values that are absent in the request are taken from the scene.
struct ChartView {
    ThinLens lens;  ///< f_number is infinite for a pinhole
    double focus_m = 1;
    std::optional<TimeSpan> shutter;
    double film_distance_mm = 0;
    int width = 0, height = 0;
    double time_s = 0;
    [[nodiscard]] bool has_lens() const;
    /// Returns the f-number that gives the trace the same lens diameter as the image. The trace computes it
    /// as film distance / f-number instead of focal length / f-number.
    [[nodiscard]] double traced_f_number() const;
};

struct PlannedTrace {
    std::string name;
    TraceSettings settings;
};

/// One point of the chart: a method and the settings with which it makes an image.
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

/// Throws Error(wrong_arguments) if neither the request nor the scene defines the lens. Also throws it if
/// nothing would blur the image, because the f-number is infinite and there is no shutter.
[[nodiscard]] ChartView chart_view(const ChartRequest& request, const Scene& scene);

/// Returns settings of a trace that records every surface that some point of the lens sees during the shutter
/// interval of this view.
[[nodiscard]] TraceSettings best_trace(const ChartRequest& request, const ChartView& view);

[[nodiscard]] ChartPlan chart_plan(const ChartRequest& request, const ChartView& view);

/// Returns settings of distributed ray tracing for this view. The caller must set the samples per pixel
/// (`spp`), the seed, and whether two half images are made (`halves`).
[[nodiscard]] RenderSettings render_settings(const ChartRequest& request, const ChartView& view);

}  // namespace postlens
