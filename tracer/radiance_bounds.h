// The most radiance that a ray can find, so that what cannot add anything visible need not be traced.
#pragma once

#include <vector>

#include "tracer/scene.h"

namespace postlens {

/// By the number of nodes left below, 0 to max_depth: the most radiance that a subtree can have. 1e100
/// and more where a light with attenuation by distance alone may touch a surface, by boxes around the
/// surfaces and around their ways.
[[nodiscard]] std::vector<double> radiance_bounds(const Scene& scene, int max_depth);

}  // namespace postlens
