#include "scene/sampled_motion.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace postlens {
namespace {

using glm::dvec3;

constexpr int most_halvings = 12;
// To measure the error of interpolation between two keyframes, the time between them is divided into this
// many equal steps. The error is measured at the 7 instants between the steps.
constexpr int looks = 8;

struct Sampler {
    const std::function<Placement(double)>& at;
    std::span<const dvec3> points;
    double tolerance_m;
    SampledMotion out;

    [[nodiscard]] TransformKey key(double t) const {
        const Placement p = at(t);
        TransformKey k{t, p.translation, p.rotation, p.scale};
        for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(k.scale[axis]) < smallest_key_scale) k.scale[axis] = smallest_key_scale;
        }
        return k;
    }

    [[nodiscard]] double error(const TransformKey& a, const TransformKey& b) const {
        const std::vector<TransformKey> pair{a, b};
        double worst = 0;
        for (int i = 1; i < looks; ++i) {
            const double t = a.time_s + (b.time_s - a.time_s) * i / looks;
            const TransformKey exact = key(t);
            const glm::dmat4 wanted = transform_at({exact}, t), got = transform_at(pair, t);
            for (const dvec3& p : points) {
                worst = std::max(worst, glm::length(dvec3((wanted - got) * glm::dvec4(p, 1))));
            }
        }
        return worst;
    }

    // Appends keyframes between the keyframes `a` and `b`, and then `b` itself. To do so, it halves the time
    // between them repeatedly, until the error of interpolation is within the tolerance or a limit of
    // halvings is reached. The caller must already have appended `a`.
    void add(const TransformKey& a, const TransformKey& b, int halvings) {
        const double gap = b.time_s - a.time_s;
        const bool may_divide = gap > 2 * shortest_key_gap_s && halvings < most_halvings;
        const double cosine = std::abs(glm::dot(a.rotation, b.rotation));
        const double widest = std::cos(glm::radians(170.0) / 2);
        const double off = gap > 2 * shortest_key_gap_s ? error(a, b) : 0;
        if (may_divide && (off > tolerance_m || cosine < widest)) {
            const TransformKey middle = key(a.time_s + gap / 2);
            add(a, middle, halvings + 1);
            add(middle, b, halvings + 1);
            return;
        }
        out.error_m = std::max(out.error_m, off);
        out.keys.push_back(b);
    }
};

}  // namespace

SampledMotion sampled_motion(const std::function<Placement(double time_s)>& at,
                             std::span<const double> times_s, std::span<const dvec3> points,
                             double tolerance_m) {
    assert(!times_s.empty());
    Sampler sampler{at, points, tolerance_m, {}};
    sampler.out.keys.push_back(sampler.key(times_s.front()));
    for (std::size_t i = 1; i < times_s.size(); ++i) {
        const TransformKey from = sampler.out.keys.back();
        sampler.add(from, sampler.key(times_s[i]), 0);
    }
    return std::move(sampler.out);
}

}  // namespace postlens
