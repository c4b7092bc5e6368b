// Keys of the keyframed motion in scenes, sample files and files of motion paths.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

namespace postlens {

/// Position and orientation at one instant. Between keys, translation and scale are interpolated linearly,
/// and rotation is interpolated by slerp.
struct TransformKey {
    double time_s = 0;
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
    [[nodiscard]] bool operator==(const TransformKey&) const = default;
};

/// Returns the transform at an instant, interpolated between keys. Before the first key and after the last
/// one, the transform is that of the nearest key.
[[nodiscard]] glm::dmat4 transform_at(const std::vector<TransformKey>& keys, double time_s);

}  // namespace postlens
