// Translates a scene so that a given point becomes the origin.
#pragma once

#include "scene/scene.h"

namespace postlens {

/// The scene with all objects, motions, lights and cameras translated by -origin. Rays are stored as floats,
/// whose rounding far from the origin would exceed the size of a lens of a few centimetres.
[[nodiscard]] Scene recentred(Scene scene, const glm::dvec3& origin);

}  // namespace postlens
