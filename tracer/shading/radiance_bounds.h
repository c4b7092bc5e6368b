// Upper bounds of the radiance along a ray, by which rays that cannot contribute visibly are omitted.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace postlens {

/// Returns upper bounds of the radiance along a ray: element k for at most k successive surface hits.
/// 1e100 or more means unbounded.
[[nodiscard]] std::vector<double> radiance_bounds(const Scene& scene, int max_depth);

}  // namespace postlens
