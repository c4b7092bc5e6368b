// Motion of objects, camera and lights. The header of a sample file stores it, so that poses can be computed
// at any instant.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "records/motion/transform_key.h"

namespace postlens {

/// The rigid motion of all shapes with the same id. Between the keyframes `keys`, the transform from object
/// space to world space is interpolated.
struct ObjectMotion {
    std::vector<TransformKey> keys;  ///< in ascending order; constant before the first and after the last
    glm::dvec3 centre_m{0};          ///< centre, in the object's space, of a sphere that encloses the object
    double radius_m = 0;
    [[nodiscard]] bool operator==(const ObjectMotion&) const = default;
};

/// A light that moves, or that lights a moving scene. Its keyframes (`keys`), if any, transform `place`.
struct LightMotion {
    bool directional = false;  ///< if true, `place` is the direction in which the light travels
    glm::dvec3 place{0};       ///< position in m, or direction
    bool casts_shadows = true;
    std::vector<TransformKey> keys;  ///< empty if the light does not move
    [[nodiscard]] bool operator==(const LightMotion&) const = default;
};

struct SceneMotion {
    std::map<std::uint32_t, ObjectMotion> objects;  ///< only objects with keys
    std::vector<TransformKey> camera;               ///< empty if the camera does not move
    std::vector<LightMotion> lights;                ///< all lights if objects move, else only moving lights
    [[nodiscard]] bool empty() const { return objects.empty() && camera.empty() && lights.empty(); }
    [[nodiscard]] bool operator==(const SceneMotion&) const = default;
};

/// Converts the motion to JSON text, which is empty if nothing moves. motion_of_text() restores exactly the
/// same values. docs/sample_file.md lists the members.
[[nodiscard]] std::string motion_text(const SceneMotion& motion);

/// Reads the motion of a scene from JSON text, which motion_text() has made. Throws Error(invalid_input) if
/// the structure or a value is invalid, for example if times do not increase. The error message begins with
/// `source`.
[[nodiscard]] SceneMotion motion_of_text(const std::string& text, const std::string& source);

}  // namespace postlens
