// The part of a scene's motion that a sample file records.
#pragma once

#include <cstdint>
#include <vector>

#include "records/motion/scene_motion.h"
#include "scene/scene.h"

namespace postlens {

/// Returns the motion of the camera, of the moving objects with their bounding spheres, and of the lights.
/// Lights at rest are included if objects move. Of shapes with one id, the first one's motion is used.
[[nodiscard]] SceneMotion recorded_motion(const Scene& scene, const Camera& camera);

/// Returns, ascending, the ids of shapes that have the same id but different keyframes.
[[nodiscard]] std::vector<std::uint32_t> ids_that_move_apart(const Scene& scene);

}  // namespace postlens
