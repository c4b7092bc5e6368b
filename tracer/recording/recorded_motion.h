// The part of a scene's motion that a sample file records.
#pragma once

#include <cstdint>
#include <vector>

#include "records/motion/scene_motion.h"
#include "scene/scene.h"

namespace postlens {

/// Returns the motion that a sample file stores: the motion of the camera, of moving objects and of lights.
/// For each moving object, its bounding sphere is also stored. Lights at rest are included if objects move,
/// because the light on surfaces then changes.
/// If several shapes have the same id, the motion of the first shape is used.
[[nodiscard]] SceneMotion recorded_motion(const Scene& scene, const Camera& camera);

/// Returns the ids, ascending, that several objects with different keyframes share. The records of such an id
/// do not all move in the same way.
[[nodiscard]] std::vector<std::uint32_t> ids_that_move_apart(const Scene& scene);

}  // namespace postlens
