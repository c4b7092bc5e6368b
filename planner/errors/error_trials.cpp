#include "planner/errors/error_trials.h"

#include <algorithm>

#include "core/files/scratch_file.h"
#include "planner/views/picture_request.h"
#include "tracer/trace.h"

namespace postlens {
namespace {

constexpr int finest_levels = 6;
constexpr int deepest_trees = NodePath::max_bounces + 1;

/// Returns the settings with which a sample file was traced. Those that its header does not contain have
/// default values.
TraceSettings settings_of(const SampleHeader& h, const RenderSettings& camera) {
    TraceSettings s;
    s.camera = camera.camera;
    s.camera_name = camera.camera_name;
    s.time_s = h.time_s;
    s.subdivision.levels = h.subdivide_levels;
    s.subdivision.threshold = h.subdivide_threshold;
    s.whitted.max_depth = h.max_depth;
    s.whitted.min_contribution = h.min_contribution;
    s.overscan_px = h.overscan_px;
    if (h.sufficient.shutter_open_s && h.sufficient.shutter_close_s) {
        s.for_shutter = TimeSpan{*h.sufficient.shutter_open_s, *h.sufficient.shutter_close_s};
        s.keys = std::max(1, static_cast<int>(h.key_times_s.size()));
    }
    s.for_f_number = h.sufficient.smallest_f_number;
    s.for_focus_m = h.sufficient.nearest_focus_m;
    if (!h.has_layers) s.hidden_layers = 0;
    return s;
}

/// Changes the settings `s` with which the scene is traced again. `view` describes the lens and the shutter
/// of the image whose errors are examined. With the changed settings, the trace records all hidden surfaces
/// that this lens sees, at instants within this exposure.
void know_the_view(const HybridSettings& view, const SampleHeader& h, TraceSettings& s) {
    if (view.focus.lens.f_number < std::numeric_limits<double>::infinity()) {
        // Sets the f-number for which the new trace records hidden surfaces. A trace knows no focal length,
        // so its f-number is defined as film distance / lens diameter. The f-number of the image is focal
        // length / lens diameter. Multiplying the latter by film distance / focal length converts it.
        s.for_f_number = view.focus.lens.f_number * h.film_distance_mm / view.focus.lens.focal_length_mm;
        s.for_focus_m = view.focus.focus_distance_m;
    }
    if (view.shutter) {
        s.for_shutter = view.shutter;
        s.keys = std::max(1, static_cast<int>(h.key_times_s.size()));
    }
}

}  // namespace

std::vector<ErrorTrial> error_trials(const SampleHeader& h, const Scene& scene, const HybridSettings& view,
                                     const FieldFocusSettings& by_field) {
    const TraceSettings as_it_was = settings_of(h, ray_settings(h, view, by_field.aperture));
    TraceSettings wider = as_it_was, whole = as_it_was, finer = as_it_was;
    know_the_view(view, h, wider);
    if (wider.for_f_number || wider.for_shutter) wider.overscan_auto = true;
    know_the_view(view, h, whole);
    whole.hidden_layers = HiddenLayers::most;
    TraceSettings longer = whole;
    longer.keys.reset();
    finer.subdivision.levels = std::clamp(h.subdivide_levels + 1, 3, finest_levels);
    finer.whitted.max_depth = deepest_trees;
    finer.whitted.min_contribution = std::min(h.min_contribution, 1e-4);

    const auto tried = [&](ErrorCause cause, const TraceSettings& settings) {
        const ScratchFile file("trial.exr");
        (void)trace_to_file(scene, settings, file.path());
        const SampleFileReader reader(file.path());
        FocusFrame frame(reader);
        return ErrorTrial{cause, field_focus(frame, by_field).image};
    };
    std::vector<ErrorTrial> out;
    out.push_back(tried(ErrorCause::record_density, finer));
    out.push_back(tried(ErrorCause::hidden_surface, whole));
    out.back().decides = true;
    out.push_back(tried(ErrorCause::frame_edge, wider));
    out.back().decides = true;
    if (by_field.shutter) {
        out.push_back(tried(ErrorCause::hidden_surface, longer));
        out.back().other_instants = true;
    }
    return out;
}

}  // namespace postlens
