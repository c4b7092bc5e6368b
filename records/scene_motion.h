// What of a scene moves: the part of a sample file's header from which every instant of the shutter follows.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "records/transform_key.h"

namespace postlens {

/// The rigid motion of one id: world(t) = key(t) * p, with p the same at all times.
struct ObjectMotion {
    std::vector<TransformKey> keys;  ///< times grow; still before the first and after the last
    glm::dvec3 centre_m{0};          ///< of a sphere that holds the object, in the space of p
    double radius_m = 0;
    [[nodiscard]] bool operator==(const ObjectMotion&) const = default;
};

/// A light that moves, or whose shadows can: where it is, before its keys.
struct LightMotion {
    bool directional = false;  ///< true: `place` is the way the light travels
    glm::dvec3 place{0};       ///< position, m, or direction
    bool casts_shadows = true;
    std::vector<TransformKey> keys;  ///< empty: still
    [[nodiscard]] bool operator==(const LightMotion&) const = default;
};

struct SceneMotion {
    std::map<std::uint32_t, ObjectMotion> objects;  ///< those with keys only
    std::vector<TransformKey> camera;               ///< empty: still
    std::vector<LightMotion> lights;                ///< those that move or cast shadows
    [[nodiscard]] bool empty() const { return objects.empty() && camera.empty() && lights.empty(); }
    [[nodiscard]] bool operator==(const SceneMotion&) const = default;
};

/// As JSON that reads back to equal values; empty where nothing is said. docs/sample_file.md lists the keys.
[[nodiscard]] std::string motion_text(const SceneMotion& motion);

/// Throws Error(invalid_input) that begins with `source` for anything but such a text: other JSON, numbers
/// that are not finite, times that do not grow, scales of 0, rotations that are no unit quaternions, id 0.
[[nodiscard]] SceneMotion motion_of_text(const std::string& text, const std::string& source);

}  // namespace postlens
