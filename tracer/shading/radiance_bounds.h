// Upper bounds of the radiance along a ray. Rays that cannot contribute visibly are not traced.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace postlens {

/// Returns bounds for k = 0 to max_depth. Element k is an upper bound of the radiance of any part of a
/// shading tree with at most k nodes along a path. The bound is 1e100 or more if the radiance may be
/// unlimited. This can happen near a light whose intensity grows without limit as the distance goes to 0.
[[nodiscard]] std::vector<double> radiance_bounds(const Scene& scene, int max_depth);

}  // namespace postlens
