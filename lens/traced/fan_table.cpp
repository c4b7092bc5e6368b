#include "lens/traced/fan_table.h"

#include <algorithm>
#include <cmath>

#include "core/threads.h"

namespace postlens {

using glm::dvec2;

FanTable::FanTable(const LensView& view, double largest_inverse_depth_per_m, double widest_tangent)
    : depth_step_per_m_(std::max({largest_inverse_depth_per_m, view.geometry().inverse_focus_per_m, 1e-6}) /
                        (depths - 1)),
      field_step_(widest_tangent / (fields - 1)),
      fans_(depths * fields),
      light_(fields),
      reach_(depths),
      change_(depths) {
    parallel_for(depths + fields, [&](std::size_t i) {
        if (i < depths) {
            trace_depth(view, i);
        } else {
            light_[i - depths] = view.light(field_step_ * static_cast<double>(i - depths));
        }
    });
}

void FanTable::trace_depth(const LensView& view, std::size_t depth) {
    const double w = depth_step_per_m_ * static_cast<double>(depth);
    dvec2 before(0), middle(0);
    for (std::size_t f = 0; f < fields; ++f) {
        const double tangent = field_step_ * static_cast<double>(f);
        PupilFan& fan = fans_[depth * fields + f];
        dvec2 at = 2.0 * middle - before;
        const bool lit = trace_fan(view, w, tangent, at, fan);
        if (lit) {
            before = f == 0 ? at : middle;
            middle = at;
        } else if (f > 0) {
            fan = fans_[depth * fields + f - 1];  // light() is 0 here
        }
        for (const PupilFan::Node& node : fan.nodes)
            reach_[depth] = std::max(reach_[depth], glm::length(node.landing));
        if (f == 0 || !lit) continue;
        const PupilFan& last = fans_[depth * fields + f - 1];
        for (std::size_t i = 0; i < fan.nodes.size(); ++i) {
            change_[depth] = std::max(
                change_[depth], glm::length(fan.nodes[i].landing - last.nodes[i].landing) / field_step_);
        }
    }
}

FanTable::Place FanTable::place(double inverse_depth_per_m, double tangent) const {
    const double d = inverse_depth_per_m / depth_step_per_m_;
    const double f = std::clamp(tangent / field_step_, 0.0, static_cast<double>(fields - 1));
    Place out;
    out.depth = static_cast<std::size_t>(std::clamp(std::floor(d), 0.0, static_cast<double>(depths - 2)));
    out.field = static_cast<std::size_t>(std::min(std::floor(f), static_cast<double>(fields - 2)));
    // `depth_part` is the distance of the inverse depth d from the table's entry `out.depth`, in steps of the
    // table. If it is not between 0 and 1, fans (bundles of rays from one object point) are extrapolated
    // linearly. Limiting this to 1000 steps keeps the results finite.
    out.depth_part = std::clamp(d - static_cast<double>(out.depth), -1e3, 1e3);
    out.field_part = f - static_cast<double>(out.field);
    return out;
}

PupilFan FanTable::fan(double inverse_depth_per_m, double tangent) const {
    const Place p = place(inverse_depth_per_m, tangent);
    const PupilFan* corner[4] = {&fans_[p.depth * fields + p.field], &fans_[p.depth * fields + p.field + 1],
                                 &fans_[(p.depth + 1) * fields + p.field],
                                 &fans_[(p.depth + 1) * fields + p.field + 1]};
    // At depths outside the table, only the landing points of the rays on the film are extrapolated. The
    // positions of the rays in the pupil and the light that they carry change little with depth. Therefore,
    // both are taken from the table's nearest depth, by limiting `depth_part` to [0, 1].
    const double inside = std::clamp(p.depth_part, 0.0, 1.0);
    PupilFan out;
    for (std::size_t i = 0; i < out.nodes.size(); ++i) {
        const auto mixed = [&](auto member, double depth_part) {
            return glm::mix(glm::mix(corner[0]->nodes[i].*member, corner[1]->nodes[i].*member, p.field_part),
                            glm::mix(corner[2]->nodes[i].*member, corner[3]->nodes[i].*member, p.field_part),
                            depth_part);
        };
        out.nodes[i] = {mixed(&PupilFan::Node::pupil_m, inside),
                        mixed(&PupilFan::Node::landing, p.depth_part), mixed(&PupilFan::Node::light, inside)};
    }
    return out;
}

double FanTable::light(double tangent) const {
    const Place p = place(0, tangent);
    return glm::mix(light_[p.field], light_[p.field + 1], p.field_part);
}

// Returns an upper bound of a quantity at an inverse depth. `values` contains the quantity for each inverse
// depth of the table. Beyond the table's ends, the bound grows linearly, because fans are extrapolated
// linearly.
double FanTable::of_depth(const std::vector<double>& values, double inverse_depth_per_m) const {
    const Place p = place(inverse_depth_per_m, 0);
    const double low = values[p.depth], high = values[p.depth + 1];
    const double beyond = std::max({0.0, -p.depth_part, p.depth_part - 1});
    return std::max(low, high) + beyond * (low + high);
}

double FanTable::reach(double inverse_depth_per_m) const {
    return of_depth(reach_, inverse_depth_per_m);
}

double FanTable::change_over_field(double inverse_depth_per_m) const {
    return of_depth(change_, inverse_depth_per_m);
}

}  // namespace postlens
