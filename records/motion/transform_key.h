// Keyframes of the motion in scenes, sample files and files of motion paths.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

namespace postlens {

/// A keyframe: position, orientation and scale at one instant. In between, translation and scale are
/// interpolated linearly, and rotation by slerp.
struct TransformKey {
    double time_s = 0;
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
    [[nodiscard]] bool operator==(const TransformKey&) const = default;
};

/// Returns the transform at an instant, interpolated between keyframes, and constant before the first and
/// after the last.
[[nodiscard]] glm::dmat4 transform_at(const std::vector<TransformKey>& keys, double time_s);

}  // namespace postlens
