// Upper bounds of the radiance along a ray. They show which rays cannot contribute visibly and need not be
// traced.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace postlens {

/// Returns bounds for k = 0 to max_depth. Element k is an upper bound of the radiance of a subtree of the
/// shading tree that has at most k nodes along a path. It is 1e100 or more if the bounding volumes of
/// surfaces may contain a light whose attenuation vanishes at distance 0.
[[nodiscard]] std::vector<double> radiance_bounds(const Scene& scene, int max_depth);

}  // namespace postlens
