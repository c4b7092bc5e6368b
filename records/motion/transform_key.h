// Keys of keyframed motion in scenes, sample files and paths.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

namespace postlens {

/// Position and orientation at one instant. Between keys, translation and scale are interpolated linearly,
/// and the rotation by slerp.
struct TransformKey {
    double time_s = 0;
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
    [[nodiscard]] bool operator==(const TransformKey&) const = default;
};

/// The transform at an instant, interpolated between keys; constant before the first and after the last key.
[[nodiscard]] glm::dmat4 transform_at(const std::vector<TransformKey>& keys, double time_s);

}  // namespace postlens
