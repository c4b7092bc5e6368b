// Motion of objects, camera and lights: the part of a sample file's header that gives their poses at any
// instant.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "records/motion/transform_key.h"

namespace postlens {

/// The rigid motion of the object with one id: world(t) = key(t) * p, where the point p does not depend on t.
struct ObjectMotion {
    std::vector<TransformKey> keys;  ///< in ascending order; constant before the first and after the last
    glm::dvec3 centre_m{0};          ///< of a sphere that encloses the object, in the space of p
    double radius_m = 0;
    [[nodiscard]] bool operator==(const ObjectMotion&) const = default;
};

/// A light that moves, or that shines on something that moves. `place` is its position or direction before
/// `keys` move it.
struct LightMotion {
    bool directional = false;  ///< true: `place` is the direction in which the light travels
    glm::dvec3 place{0};       ///< position, m, or direction
    bool casts_shadows = true;
    std::vector<TransformKey> keys;  ///< empty: does not move
    [[nodiscard]] bool operator==(const LightMotion&) const = default;
};

struct SceneMotion {
    std::map<std::uint32_t, ObjectMotion> objects;  ///< only objects with keys
    std::vector<TransformKey> camera;               ///< empty: does not move
    std::vector<LightMotion> lights;                ///< all lights if objects move; else only moving lights
    [[nodiscard]] bool empty() const { return objects.empty() && camera.empty() && lights.empty(); }
    [[nodiscard]] bool operator==(const SceneMotion&) const = default;
};

/// Converts the motion to JSON text from which motion_of_text restores equal values; empty for an empty
/// motion. docs/sample_file.md lists the keys.
[[nodiscard]] std::string motion_text(const SceneMotion& motion);

/// Reads the text that motion_text writes. Throws Error(invalid_input), with a message that begins with
/// `source`, for other JSON, numbers that are not finite, times that do not increase, scales of 0, rotations
/// that are not unit quaternions, and id 0.
[[nodiscard]] SceneMotion motion_of_text(const std::string& text, const std::string& source);

}  // namespace postlens
