// The part of a scene's motion that a sample file records.
#pragma once

#include <cstdint>
#include <vector>

#include "records/motion/scene_motion.h"
#include "scene/scene.h"

namespace postlens {

/// Returns the motion of the camera, the moving objects with their bounding spheres, and the lights that move
/// or whose shadows may move. If several moving shapes have the same id, the motion of the first one is used.
[[nodiscard]] SceneMotion recorded_motion(const Scene& scene, const Camera& camera);

/// Returns, in ascending order, the ids that are shared by shapes with different keyframes. Such shapes move
/// differently.
[[nodiscard]] std::vector<std::uint32_t> ids_that_move_apart(const Scene& scene);

}  // namespace postlens
