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
    double error_m = 0;  ///< greatest error of a point at the times that were tested
};

/// Approximates the motion `at` by keyframes. There is one at each of the ascending `times_s` (at least one).
/// Others are added until the interpolated positions of `points` are within `tolerance_m` of the exact ones.
///
/// A gap between two keyframes is halved if the error is too large at one of seven times within it.
/// It is also halved for a rotation above 170 degrees, whose direction two keyframes do not determine.
/// A gap between given times is divided into at most 2^12 parts, each at least 1 microsecond long.
/// Scales of 0 become smallest_key_scale, so that transforms can be inverted.
[[nodiscard]] SampledMotion sampled_motion(const std::function<Placement(double time_s)>& at,
                                           std::span<const double> times_s,
                                           std::span<const glm::dvec3> points, double tolerance_m);

inline constexpr double smallest_key_scale = 1e-6;
/// Shortest gap between keyframes, s. If a motion jumps, there is also a keyframe this long before the jump.
inline constexpr double shortest_key_gap_s = 1e-6;

}  // namespace postlens
