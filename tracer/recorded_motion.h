// What of a scene's motion a sample file records.
#pragma once

#include <cstdint>
#include <vector>

#include "records/scene_motion.h"
#include "tracer/scene.h"

namespace postlens {

/// What moves, with a sphere around each moving id, and the lights whose shadows may. Where shapes of one id
/// move differently, the first that moves stands for all.
[[nodiscard]] SceneMotion recorded_motion(const Scene& scene, const Camera& camera);

/// The ids, growing, that several shapes share which do not all have the same keys.
[[nodiscard]] std::vector<std::uint32_t> ids_that_move_apart(const Scene& scene);

}  // namespace postlens
