#include "motionblur/moving_group.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "motionblur/fit_path.h"

namespace postlens {
namespace {

constexpr double alike_px = 0.02;

glm::dvec2 displacement(const FrameMotion& motion, const IdMotion& id, double recorded_s, double time_s) {
    const RasterMap map = motion.map(id.id, recorded_s, time_s);
    if (map.identity()) return {0, 0};
    const auto to = map(id.centre);
    if (!to) {
        fail(ExitCode::wrong_arguments,
             "--method convolve: object {} passes the camera at {} s and has no path (expected lightfield or "
             "auto)",
             id.id, time_s);
    }
    return {to->x - id.centre.x, to->y - id.centre.y};
}

bool alike(const FrameMotion& motion, const IdMotion& a, const IdMotion& b, double recorded_s,
           const Exposure& exposure) {
    std::vector<double> breaks = motion.breaks_s(a.id);
    const std::vector<double> others = motion.breaks_s(b.id);
    breaks.insert(breaks.end(), others.begin(), others.end());
    for (const double t : probe_times(breaks, exposure)) {
        const glm::dvec2 d = displacement(motion, a, recorded_s, t) - displacement(motion, b, recorded_s, t);
        if (!(glm::length(d) <= alike_px)) return false;
    }
    return true;
}

}  // namespace

std::vector<MovingGroup> find_groups(const FrameMotion& motion, const std::vector<IdMotion>& ids,
                                     const IdExtents& extents, double recorded_s, const Exposure& exposure,
                                     const std::optional<double>& fit_px) {
    std::vector<MovingGroup> out;
    std::vector<const IdMotion*> first;
    for (const IdMotion& m : ids) {
        if (m.kind == MotionKind::still) continue;
        std::size_t g = 0;
        while (g < out.size() && !alike(motion, *first[g], m, recorded_s, exposure)) ++g;
        if (g == out.size()) {
            out.emplace_back();
            first.push_back(&m);
        }
        out[g].ids.push_back(m.id);
        out[g].extent.add(extents.at(m.id));
    }
    for (std::size_t g = 0; g < out.size(); ++g) {
        MovingGroup& group = out[g];
        std::sort(group.ids.begin(), group.ids.end());
        group.inverse_z = group.extent.centre().inverse_z;
        const IdMotion& of = *first[g];
        const std::vector<double> breaks = motion.breaks_s(of.id);
        group.path = flatten([&](double t) { return displacement(motion, of, recorded_s, t); }, breaks,
                             exposure.open_s, exposure.close_s);
        group.points = group.path.size();
        if (fit_px && group.path.size() > 1) {
            const PathFit fit = fit_path(group.path, *fit_px);
            group.fitted_knots = fit.path.knots();
            group.fit_error_px = fit.error_px;
            group.path = fit.path.flatten(exposure.open_s, exposure.close_s);
        }
    }
    std::stable_sort(out.begin(), out.end(),
                     [](const MovingGroup& a, const MovingGroup& b) { return a.inverse_z > b.inverse_z; });
    return out;
}

}  // namespace postlens
