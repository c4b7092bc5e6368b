// The part of a scene's motion that a sample file records.
#pragma once

#include <cstdint>
#include <vector>

#include "records/motion/scene_motion.h"
#include "scene/scene.h"

namespace postlens {

/// The moving objects with their bounding spheres, the camera's motion, and the lights that move or whose
/// shadows may move. If shapes of one id move differently, the first moving shape stands for all.
[[nodiscard]] SceneMotion recorded_motion(const Scene& scene, const Camera& camera);

/// The ids, ascending, whose shapes move differently, because their keys differ.
[[nodiscard]] std::vector<std::uint32_t> ids_that_move_apart(const Scene& scene);

}  // namespace postlens
