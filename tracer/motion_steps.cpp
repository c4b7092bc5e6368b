#include "tracer/motion_steps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace postlens {
namespace {

using glm::dmat4;
using glm::dvec3;

dvec3 apply(const dmat4& m, const dvec3& p) {
    return dvec3(m * glm::dvec4(p, 1));
}

std::array<dvec3, 8> corners(const Bounds& box) {
    std::array<dvec3, 8> out;
    for (std::size_t i = 0; i < 8; ++i) {
        out[i] = {(i & 1U) != 0 ? box.max.x : box.min.x, (i & 2U) != 0 ? box.max.y : box.min.y,
                  (i & 4U) != 0 ? box.max.z : box.min.z};
    }
    return out;
}

dmat4 mixed(const dmat4& a, const dmat4& b, double share) {
    return a * (1 - share) + b * share;
}

// The difference of two affine maps is affine, its length convex: over a box it is greatest at a corner.
double error_px(const std::array<dvec3, 8>& box, const dmat4& truth, const dmat4& taken, double time_s,
                const MotionAccuracy& accuracy) {
    double farthest_m = 0, scale = 0;
    for (const dvec3& c : box) {
        const dvec3 p = apply(truth, c);
        farthest_m = std::max(farthest_m, glm::length(p - apply(taken, c)));
        scale = std::max(scale, accuracy.px_per_m(p, time_s));
    }
    return farthest_m * scale;
}

}  // namespace

MotionSteps motion_steps(const MotionPath& path, const dmat4& base, const Bounds& box, double begin_s,
                         double end_s, const MotionAccuracy& accuracy) {
    const auto points = corners(box);
    const auto at = [&](double time_s) { return path.at(time_s).matrix() * base; };
    MotionSteps out;
    for (int steps = 1; steps <= most_motion_steps; steps *= 2) {
        out.world_from_object.clear();
        for (int i = 0; i <= steps; ++i) {
            out.world_from_object.push_back(at(begin_s + (end_s - begin_s) * i / steps));
        }
        out.error_px = 0;
        for (int i = 0; i < steps; ++i) {
            const auto k = static_cast<std::size_t>(i);
            for (const double share : {0.25, 0.5, 0.75}) {
                const double time_s = begin_s + (end_s - begin_s) * (i + share) / steps;
                const dmat4 taken = mixed(out.world_from_object[k], out.world_from_object[k + 1], share);
                out.error_px = std::max(out.error_px, error_px(points, at(time_s), taken, time_s, accuracy));
            }
        }
        if (out.error_px <= accuracy.tolerance_px) break;
    }
    return out;
}

std::vector<Bounds> moving_bounds(const MotionPath& path, const Shape& shape, const dmat4& base,
                                  double begin_s, double end_s, int steps) {
    // Embree takes no bounds beyond about 1.8e18, and differences must stay finite.
    constexpr double farthest = 1e18;
    const auto at = [&](double time_s) {
        Bounds b = shape_bounds(shape, path.at(time_s).matrix() * base);
        b.min = glm::clamp(b.min, dvec3(-farthest), dvec3(farthest));
        b.max = glm::clamp(b.max, dvec3(-farthest), dvec3(farthest));
        return b;
    };
    std::vector<Bounds> out;
    for (int i = 0; i <= steps; ++i) out.push_back(at(begin_s + (end_s - begin_s) * i / steps));
    // How far the true box reaches out of the one between steps: looked for between steps and at keys, where
    // the motion may have a kink, and doubled, since the greatest excess may lie between the places looked
    // at.
    std::vector<double> shares;
    constexpr int looks = 8;
    for (int i = 0; i < steps * looks; ++i) shares.push_back((i + 0.5) / (steps * looks));
    for (const double t : path.intervals(begin_s, end_s)) shares.push_back((t - begin_s) / (end_s - begin_s));
    dvec3 excess(0);
    for (const double share : shares) {
        const double position = std::clamp(share, 0.0, 1.0) * steps;
        const auto k = static_cast<std::size_t>(std::min(position, steps - 1.0));
        const double within = position - static_cast<double>(k);
        const Bounds b = at(begin_s + (end_s - begin_s) * share);
        excess = glm::max(excess, glm::mix(out[k].min, out[k + 1].min, within) - b.min);
        excess = glm::max(excess, b.max - glm::mix(out[k].max, out[k + 1].max, within));
    }
    for (Bounds& b : out) {
        b.min -= 2.0 * excess;
        b.max += 2.0 * excess;
    }
    return out;
}

}  // namespace postlens
