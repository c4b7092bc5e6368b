// Computes bounding boxes of shapes.
#pragma once

#include <glm/glm.hpp>
#include <limits>

#include "scene/scene.h"

namespace postlens {

struct Bounds {
    glm::dvec3 min{std::numeric_limits<double>::infinity()};
    glm::dvec3 max{-std::numeric_limits<double>::infinity()};

    [[nodiscard]] bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    void add(const glm::dvec3& p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
    void add(const Bounds& other) {
        min = glm::min(min, other.min);
        max = glm::max(max, other.max);
    }
};

/// Returns the axis-aligned bounding box of the shape in the world, in metres, tight except for rounding.
/// It is infinite for a plane, and empty for an empty mesh.
[[nodiscard]] Bounds shape_bounds(const Shape& shape, const glm::dmat4& world_from_object);

}  // namespace postlens
