// Upper bounds of the radiance along a ray. Rays that cannot contribute visibly are not traced.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace postlens {

/// Returns upper bounds of radiance. Element k, 0 to max_depth, is for shading trees at most k nodes deep.
/// A bound of 1e100 or more means none, as near a light whose intensity grows without limit.
[[nodiscard]] std::vector<double> radiance_bounds(const Scene& scene, int max_depth);

}  // namespace postlens
