// Approximates any motion by keys with linear interpolation.
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

/// Keys at the ascending `times_s` (at least one), and as many keys between them as keep `points` within
/// `tolerance_m` of their positions by `at`. Each gap is halved, into at most 2^12 parts of at least 1
/// microsecond, until the error at seven instants in the gap is within the tolerance. A gap in which the
/// rotation exceeds 170 degrees is halved as well, since two keys do not determine the direction of such a
/// rotation. Scales of 0 become smallest_key_scale, so that transforms stay invertible.
[[nodiscard]] SampledMotion sampled_motion(const std::function<Placement(double time_s)>& at,
                                           std::span<const double> times_s,
                                           std::span<const glm::dvec3> points, double tolerance_m);

inline constexpr double smallest_key_scale = 1e-6;
/// Shortest gap between keys, s. A motion that jumps at a key is represented by another key at this time
/// before it.
inline constexpr double shortest_key_gap_s = 1e-6;

}  // namespace postlens
