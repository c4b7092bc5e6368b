// Upper bounds of the radiance along a ray, so that rays that cannot contribute visibly are not traced.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace postlens {

/// Element k of the result is an upper bound of the radiance of a subtree of the shading tree that has at
/// most k nodes along a path, k = 0 to max_depth. The bound is 1e100 or more if a light whose attenuation
/// vanishes at distance 0 may touch a surface, judged by the surfaces' bounding volumes.
[[nodiscard]] std::vector<double> radiance_bounds(const Scene& scene, int max_depth);

}  // namespace postlens
