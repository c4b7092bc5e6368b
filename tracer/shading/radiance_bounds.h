// Upper bounds of the radiance along a ray. Rays that cannot contribute visibly are not traced.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace postlens {

/// Returns upper bounds of radiance for k = 0 to max_depth. Element k bounds the radiance of a ray whose
/// shading tree has at most k nodes along any path. A bound is 1e100 or more if the radiance may be
/// unlimited, for example near a light whose intensity grows without limit as the distance goes to 0.
[[nodiscard]] std::vector<double> radiance_bounds(const Scene& scene, int max_depth);

}  // namespace postlens
