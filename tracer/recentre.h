// The scene moved so that a point becomes the origin.
#pragma once

#include "tracer/scene.h"

namespace postlens {

/// Every placement, motion, light and camera moved by -origin. Rays are floats: far from the origin a lens of
/// a few centimetres would be lost in their rounding.
[[nodiscard]] Scene recentred(Scene scene, const glm::dvec3& origin);

}  // namespace postlens
