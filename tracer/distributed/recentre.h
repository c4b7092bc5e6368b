// Translates a scene so that a given point becomes the origin.
#pragma once

#include "scene/scene.h"

namespace postlens {

/// Returns the scene translated by -origin.
/// Far from the world's origin, rounding errors of float rays would exceed the size of a small lens.
[[nodiscard]] Scene recentred(Scene scene, const glm::dvec3& origin);

}  // namespace postlens
