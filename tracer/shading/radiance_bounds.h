// Upper bounds of the radiance along a ray. They show which rays cannot contribute visibly. Such rays are not
// traced.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace postlens {

/// Returns upper bounds of radiance for k = 0 to max_depth. Element k bounds the radiance of a ray whose
/// shading tree is at most k nodes deep. It is 1e100 or more if the radiance has no bound, for example near a
/// light whose intensity grows without limit at small distances.
[[nodiscard]] std::vector<double> radiance_bounds(const Scene& scene, int max_depth);

}  // namespace postlens
