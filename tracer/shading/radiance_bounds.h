// Upper bounds of the radiance along a ray, by which rays that cannot contribute visibly are omitted.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace postlens {

/// Returns upper bounds of the radiance along a ray. Element k is for rays followed over at most k surfaces.
/// A value of 1e100 or more means no bound, as near a light whose intensity grows without limit.
[[nodiscard]] std::vector<double> radiance_bounds(const Scene& scene, int max_depth);

}  // namespace postlens
