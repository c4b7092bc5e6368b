#include "tracer/intersection/motion_steps.h"

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
    std::array<dvec3, 8> out{};
    for (std::size_t i = 0; i < 8; ++i) {
        out[i] = {(i & 1U) != 0 ? box.max.x : box.min.x, (i & 2U) != 0 ? box.max.y : box.min.y,
                  (i & 4U) != 0 ? box.max.z : box.min.z};
    }
    return out;
}

dmat4 mixed(const dmat4& a, const dmat4& b, double share) {
    return a * (1 - share) + b * share;
}

// Returns the largest error that an approximate transform, `taken`, causes in a box, compared with the exact
// transform `truth`. The error is in px. It is a convex function of the point, so it is largest at a corner
// of the box. Therefore, only the corners are tested.
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
    // Clamps infinite bounding boxes, because Embree rejects bounds beyond about 1.8e18.
    constexpr double farthest = 1e18;
    const auto at = [&](double time_s) {
        Bounds b = shape_bounds(shape, path.at(time_s).matrix() * base);
        b.min = glm::clamp(b.min, dvec3(-farthest), dvec3(farthest));
        b.max = glm::clamp(b.max, dvec3(-farthest), dvec3(farthest));
        return b;
    };
    std::vector<Bounds> out;
    for (int i = 0; i <= steps; ++i) out.push_back(at(begin_s + (end_s - begin_s) * i / steps));
    // Measures how far a moving shape extends beyond the boxes that Embree interpolates linearly between time
    // steps. `excess` is how far it does so at the tested instants. `bend`, the second difference of
    // successive exact boxes, limits how much farther it extends in between.
    dvec3 excess(0), bend(0);
    constexpr int looks = 8;
    const std::vector<double> keys = path.intervals(begin_s, end_s);
    for (std::size_t stretch = 0; stretch + 1 < keys.size(); ++stretch) {
        const double from_s = keys[stretch], length_s = keys[stretch + 1] - from_s;
        const int places =
            std::max(2, static_cast<int>(std::ceil(looks * steps * length_s / (end_s - begin_s))));
        std::array<Bounds, 3> last;
        for (int i = 0; i <= places; ++i) {
            const double time_s = from_s + length_s * i / places;
            const Bounds b = at(time_s);
            last = {last[1], last[2], b};
            if (i >= 2) {
                bend = glm::max(bend, glm::abs(last[0].min - 2.0 * last[1].min + last[2].min));
                bend = glm::max(bend, glm::abs(last[0].max - 2.0 * last[1].max + last[2].max));
            }
            const double position = std::clamp((time_s - begin_s) / (end_s - begin_s), 0.0, 1.0) * steps;
            const auto k = static_cast<std::size_t>(std::min(position, steps - 1.0));
            const double within = position - static_cast<double>(k);
            excess = glm::max(excess, glm::mix(out[k].min, out[k + 1].min, within) - b.min);
            excess = glm::max(excess, b.max - glm::mix(out[k].max, out[k + 1].max, within));
        }
    }
    excess += 0.25 * bend;
    for (Bounds& b : out) {
        b.min -= excess;
        b.max += excess;
    }
    return out;
}

}  // namespace postlens
