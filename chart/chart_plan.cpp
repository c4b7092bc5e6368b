#include "chart/chart_plan.h"

#include <cmath>
#include <fmt/format.h>

#include "core/error.h"

namespace postlens {
namespace {

constexpr const char* best_records = "records";
constexpr const char* visible_records = "visible only";
constexpr const char* coarse_records = "coarse";

// Plans the three sample files of a chart: with the best settings, without hidden surfaces, and with pixels
// subdivided only once. The images made from these files have different errors. The comparison shows how much
// hidden surfaces and further subdivision improve an image.
std::vector<PlannedTrace> traces_of(const ChartRequest& request, const ChartView& view) {
    const TraceSettings best = best_trace(request, view);
    TraceSettings visible = best, coarse = best;
    visible.hidden_layers = 0;
    coarse.subdivide_for_lens = false;
    coarse.subdivision.levels = TraceSettings::ray_levels;
    return {{best_records, best}, {visible_records, visible}, {coarse_records, coarse}};
}

class Points {
  public:
    explicit Points(std::vector<PlannedPoint>& to) : to_(to) {}

    void add(PlannedPoint::Kind kind, const std::string& method, const char* letter, int amount,
             const std::string& trace, FocusMethod focus, MotionMethod motion = MotionMethod::automatic) {
        PlannedPoint p{.kind = kind, .trace = trace, .amount = amount, .focus = focus, .motion = motion};
        p.curve = trace.empty() || trace == best_records ? method : method + ", " + trace;
        p.name = amount > 0 ? fmt::format("{} {}={}", p.curve, letter, amount) : p.curve;
        to_.push_back(std::move(p));
    }

  private:
    std::vector<PlannedPoint>& to_;
};

void add_focus(const ChartRequest& request, Points& out) {
    using Kind = PlannedPoint::Kind;
    for (const int k : request.depths)
        out.add(Kind::focus, "scatter", "K", k, best_records, FocusMethod::scatter);
    out.add(Kind::focus, "layers", "", 0, coarse_records, FocusMethod::layers);
    out.add(Kind::focus, "layers", "", 0, visible_records, FocusMethod::layers);
    out.add(Kind::focus, "layers", "", 0, best_records, FocusMethod::layers);
    for (const char* trace : {coarse_records, visible_records, best_records}) {
        for (const int m : request.views)
            out.add(Kind::focus, "lightfield", "M", m, trace, FocusMethod::lightfield);
    }
    // Adds the method hybrid, once for each number of views (images seen from single lens points) that the
    // chart compares. It uses the sample file with the fewest samples. That file suffices, because the method
    // itself traces rays where data are missing in the file.
    for (const int m : request.views)
        out.add(Kind::focus, "hybrid", "M", m, coarse_records, FocusMethod::hybrid);
}

void add_motion(const ChartRequest& request, Points& out) {
    using Kind = PlannedPoint::Kind;
    for (const char* trace : {coarse_records, visible_records, best_records})
        out.add(Kind::motionblur, "convolve", "", 0, trace, FocusMethod::pinhole, MotionMethod::convolve);
    for (const int m : request.views) {
        out.add(Kind::motionblur, "lightfield", "M", m, best_records, FocusMethod::pinhole,
                MotionMethod::lightfield);
    }
    out.add(Kind::motionblur, "auto", "", 0, best_records, FocusMethod::pinhole, MotionMethod::automatic);
}

void add_shoot(const ChartRequest& request, Points& out) {
    using Kind = PlannedPoint::Kind;
    for (const char* trace : {coarse_records, visible_records, best_records}) {
        for (const int m : request.views)
            out.add(Kind::shoot, "lightfield", "M", m, trace, FocusMethod::lightfield);
    }
    for (const int m : request.views)
        out.add(Kind::shoot, "hybrid", "M", m, coarse_records, FocusMethod::hybrid);
}

// Throws an error that names the wrong option if the lens is invalid. Without this check, tracing the scene
// would fail later, without naming an option of the command `chart`.
void check_lens(const ChartView& view) {
    const auto positive = [](const char* option, double value, bool infinite) {
        if (value > 0 && (infinite || std::isfinite(value))) return;
        fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected more than 0)", option, value);
    };
    positive("--focal-length", view.lens.focal_length_mm, false);
    positive("--f-number", view.lens.f_number, true);
    positive("--focus", view.focus_m, true);
    if (view.shutter) check_shutter("--shutter", *view.shutter);
    const double traced = view.traced_f_number();
    if (view.has_lens() && !(traced > 0 && std::isfinite(traced))) {
        fail(ExitCode::wrong_arguments,
             "--f-number: no aperture for --focal-length (got {} at {} mm; expected a diameter more than 0)",
             view.lens.f_number, view.lens.focal_length_mm);
    }
}

}  // namespace

double ChartView::traced_f_number() const {
    return lens.f_number * film_distance_mm / lens.focal_length_mm;
}

bool ChartView::has_lens() const {
    return std::isfinite(lens.f_number);
}

ChartView chart_view(const ChartRequest& request, const Scene& scene) {
    const Camera& camera = find_camera(scene, request.camera_name);
    const CameraModel model(camera, scene.time_s, request.camera);
    if (model.projection != Camera::Projection::perspective) {
        fail(ExitCode::wrong_arguments,
             "{}: an orthographic camera has no lens (got '{}'; expected a "
             "perspective one)",
             request.scene.string(), camera.name);
    }
    ChartView out;
    out.width = model.width;
    out.height = model.height;
    out.time_s = scene.time_s;
    out.film_distance_mm = model.film_distance_mm;
    out.lens.focal_length_mm = request.focal_length_mm.value_or(model.film_distance_mm);
    out.shutter = request.shutter;
    const auto f_number = request.f_number ? request.f_number : camera.f_number;
    if (!f_number && !out.shutter) {
        fail(ExitCode::wrong_arguments,
             "--f-number: missing (got nothing; expected a value, as the scene's "
             "camera names none and no --shutter is given)");
    }
    out.lens.f_number = f_number.value_or(std::numeric_limits<double>::infinity());
    const auto focus = request.focus_m ? request.focus_m : camera.focus_m;
    if (out.has_lens() && !focus) {
        fail(ExitCode::wrong_arguments,
             "--focus: missing (got nothing; expected a value, as the scene's camera names none)");
    }
    out.focus_m = focus.value_or(1);
    if (!out.has_lens() && !out.shutter) {
        fail(ExitCode::wrong_arguments,
             "--f-number: nothing blurs (got inf without --shutter; expected a "
             "finite f-number or a shutter)");
    }
    check_lens(out);
    return out;
}

TraceSettings best_trace(const ChartRequest& request, const ChartView& view) {
    TraceSettings out;
    out.camera = request.camera;
    out.camera_name = request.camera_name;
    out.subdivide_for_lens = view.has_lens();
    if (view.shutter) {
        out.subdivision.levels = 4;
        out.for_shutter = view.shutter;
        out.keys.reset();
    }
    if (view.has_lens()) {
        out.for_f_number = view.traced_f_number();
        out.for_focus_m = view.focus_m;
    }
    out.overscan_auto = true;
    return out;
}

ChartPlan chart_plan(const ChartRequest& request, const ChartView& view) {
    ChartPlan out;
    out.traces = traces_of(request, view);
    Points points(out.points);
    using Kind = PlannedPoint::Kind;
    points.add(Kind::focus, "pinhole", "", 0, best_records, FocusMethod::pinhole);
    if (view.has_lens() && view.shutter) {
        add_shoot(request, points);
    } else if (view.has_lens()) {
        add_focus(request, points);
    } else {
        add_motion(request, points);
    }
    for (const int spp : request.spp) points.add(Kind::rays, "rays", "spp", spp, "", FocusMethod::pinhole);
    return out;
}

RenderSettings render_settings(const ChartRequest& request, const ChartView& view) {
    RenderSettings out;
    out.camera = request.camera;
    out.camera_name = request.camera_name;
    out.focal_length_mm = view.lens.focal_length_mm;
    out.f_number = view.lens.f_number;
    out.focus_m = view.focus_m;
    out.shutter = view.shutter;
    return out;
}

void check_chart_request(const ChartRequest& r) {
    const auto in_range = [](const char* option, const std::vector<int>& values, int least, int greatest) {
        for (const int v : values) {
            if (v < least || v > greatest) {
                fail(ExitCode::wrong_arguments, "{}: out of range (got {}; expected {} to {})", option, v,
                     least, greatest);
            }
        }
    };
    in_range("--rays", r.spp, 1, 1 << 20);
    in_range("--views", r.views, 1, most_lens_views);
    in_range("--depths", r.depths, 2, DepthLevels::most_depths);
    in_range("--reference-spp", {r.reference_spp}, 1, 1 << 19);
    in_range("--rounds", {r.rounds}, 1, 100);
    if (!(r.once_above_s >= 0)) {
        fail(ExitCode::wrong_arguments, "--once-above: out of range (got {}; expected 0 or more)",
             r.once_above_s);
    }
    if (r.second_reference && !r.reference)
        fail(ExitCode::wrong_arguments, "--noise: belongs to --reference (got none; expected a picture)");
}

}  // namespace postlens
