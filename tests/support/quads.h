// Meshes of separate quads, such as the leaves of a tree.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "scene/scene.h"

namespace postlens::test {

/// The corners of a quad, in the order of its outline.
using Quad = std::array<glm::dvec3, 4>;

/// A mesh in which every quad has its own corners.
inline std::shared_ptr<const Mesh> mesh_of(const std::vector<Quad>& quads) {
    auto out = std::make_shared<Mesh>();
    for (const Quad& q : quads) {
        const auto first = static_cast<std::uint32_t>(out->positions.size());
        for (const glm::dvec3& p : q) out->positions.emplace_back(p);
        out->triangles.emplace_back(first, first + 1, first + 2);
        out->triangles.emplace_back(first, first + 2, first + 3);
    }
    return out;
}

}  // namespace postlens::test
