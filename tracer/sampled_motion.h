// Motion of any kind as keys between which everything goes evenly.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "records/transform_key.h"
#include "tracer/placement.h"

namespace postlens {

struct SampledMotion {
    std::vector<TransformKey> keys;
    double error_m = 0;  ///< how far a point strays at the instants that were looked at
};

/// Keys at the growing `times_s` (at least one), and as many between as keep `points` within `tolerance_m` of
/// where `at` takes them: each gap is halved, up to 2^12 parts and down to 1 microsecond, until seven
/// instants in it agree. A turn of more than 170 degrees is divided as well, since it says nothing about its
/// direction. Scales of 0 become smallest_key_scale: nothing can be seen from inside a point.
[[nodiscard]] SampledMotion sampled_motion(const std::function<Placement(double time_s)>& at,
                                           std::span<const double> times_s,
                                           std::span<const glm::dvec3> points, double tolerance_m);

inline constexpr double smallest_key_scale = 1e-6;
/// Shortest gap that is divided, s; also how long before its key a motion in steps begins to jump.
inline constexpr double shortest_key_gap_s = 1e-6;

}  // namespace postlens
