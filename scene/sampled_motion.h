// Approximates an arbitrary motion by keyframes with linear interpolation.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "records/motion/transform_key.h"
#include "scene/placement.h"

namespace postlens {

struct SampledMotion {
    std::vector<TransformKey> keys;
    double error_m = 0;  ///< greatest error of a point at the instants that were tested
};

/// Returns keys at the ascending `times_s` (at least one), and further keys between them where they are
/// needed: the interpolated positions of `points` must lie within `tolerance_m` of the positions that `at`
/// gives. Each gap is halved until the error at seven instants in it is small enough, but into at most 2^12
/// parts of at least 1 microsecond. A gap in which the rotation exceeds 170 degrees is also halved, because
/// two keys do not determine the direction of such a rotation. Scales of 0 become smallest_key_scale, so that
/// transforms stay invertible.
[[nodiscard]] SampledMotion sampled_motion(const std::function<Placement(double time_s)>& at,
                                           std::span<const double> times_s,
                                           std::span<const glm::dvec3> points, double tolerance_m);

inline constexpr double smallest_key_scale = 1e-6;
/// Shortest gap between keys, s. If a motion jumps at a key, another key is added this much earlier.
inline constexpr double shortest_key_gap_s = 1e-6;

}  // namespace postlens
