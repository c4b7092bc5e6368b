// Upper bounds of the radiance along a ray. Rays that cannot contribute visibly are not traced.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace postlens {

/// Returns bounds for k = 0 to max_depth. Element k is an upper bound of the radiance of any subtree of the
/// shading tree with at most k nodes along a path. The bound is 1e100 or more if the radiance may be
/// unlimited. This is the case if the attenuation of a light vanishes at distance 0 and the bounding volume
/// of a surface may contain this light.
[[nodiscard]] std::vector<double> radiance_bounds(const Scene& scene, int max_depth);

}  // namespace postlens
