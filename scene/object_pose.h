// The pose of an object at a given time.
#pragma once

#include "scene/scene.h"

namespace postlens {

/// Returns the affine map from object to world coordinates (in metres) at a time on the scene's clock, s.
[[nodiscard]] inline glm::dmat4 world_at(const Object& object, double time_s) {
    return object.keys.empty() ? object.world_from_object
                               : transform_at(object.keys, time_s) * object.motion_base;
}

}  // namespace postlens
