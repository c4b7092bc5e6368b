// Translates a scene so that a given point becomes the origin.
#pragma once

#include "scene/scene.h"

namespace postlens {

/// Returns the scene with all objects, motions, lights and cameras translated by -origin.
/// Rays are floats, whose rounding errors far from the origin would exceed the size of a small lens.
[[nodiscard]] Scene recentred(Scene scene, const glm::dvec3& origin);

}  // namespace postlens
