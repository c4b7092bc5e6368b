#include "motionblur/groups/moving_group.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "motionblur/paths/fit_path.h"

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

/// Returns whether two objects have the same displacement in the image at all instants of the exposure. If
/// `nearest` is above 0, both displacements are first scaled to this inverse depth, in 1/m, because
/// displacements with parallax are proportional to inverse depth.
bool alike(const FrameMotion& motion, const IdMotion& a, const IdMotion& b, double recorded_s,
           const Exposure& exposure, double nearest) {
    const double scale_a = nearest > 0 ? nearest / a.inverse_z : 1,
                 scale_b = nearest > 0 ? nearest / b.inverse_z : 1;
    std::vector<double> breaks = motion.breaks_s(a.id);
    const std::vector<double> others = motion.breaks_s(b.id);
    breaks.insert(breaks.end(), others.begin(), others.end());
    for (const double t : probe_times(breaks, exposure)) {
        const glm::dvec2 d = scale_a * displacement(motion, a, recorded_s, t) -
                             scale_b * displacement(motion, b, recorded_s, t);
        if (!(glm::length(d) <= alike_px)) return false;
    }
    return true;
}

bool overlap_in_depth(const IdExtent& a, const IdExtent& b) {
    return a.inverse_z_min <= b.inverse_z_max && b.inverse_z_min <= a.inverse_z_max;
}

}  // namespace

double longest_way_px(const MovingGroup& group) {
    double longest = 0;
    for (const PathPoint& p : group.path) longest = std::max(longest, glm::length(p.at_px));
    return longest;
}

double parallax_px(const MovingGroup& group) {
    if (!group.has_parallax) return 0;
    return longest_way_px(group) * (group.extent.inverse_z_max - group.extent.inverse_z_min) /
           group.path_inverse_z;
}

std::vector<MovingGroup> find_groups(const FrameMotion& motion, const std::vector<IdMotion>& ids,
                                     const IdExtents& extents, double recorded_s, const Exposure& exposure,
                                     const std::optional<double>& fit_px) {
    std::vector<MovingGroup> out;
    std::vector<const IdMotion*> first;
    const auto belongs = [&](const IdMotion& m, const MovingGroup& group, const IdMotion& to) {
        const bool parallax = m.kind == MotionKind::parallax;
        if (parallax != group.has_parallax) return false;
        if (!parallax) return alike(motion, to, m, recorded_s, exposure, 0);
        const IdExtent& own = extents.at(m.id);
        return overlap_in_depth(own, group.extent) &&
               alike(motion, to, m, recorded_s, exposure,
                     std::max(own.inverse_z_max, group.extent.inverse_z_max));
    };
    for (const IdMotion& m : ids) {
        if (m.kind == MotionKind::still) continue;
        std::size_t g = 0;
        while (g < out.size() && !belongs(m, out[g], *first[g])) ++g;
        if (g == out.size()) {
            out.emplace_back();
            out.back().has_parallax = m.kind == MotionKind::parallax;
            out.back().path_inverse_z = m.inverse_z;
            first.push_back(&m);
        }
        out[g].ids.push_back(m.id);
        out[g].extent.add(extents.at(m.id));
    }
    for (std::size_t g = 0; g < out.size(); ++g) {
        MovingGroup& group = out[g];
        std::sort(group.ids.begin(), group.ids.end());
        group.inverse_z = group.extent.centre().inverse_z;
        // So far, has_parallax states whether near points of the group move farther than distant points at
        // any recorded instant. But only the surfaces of the instant `recorded_s` are blurred. If their
        // depths are all equal, the group has no parallax.
        group.has_parallax = group.has_parallax && group.extent.inverse_z_max > group.extent.inverse_z_min;
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
