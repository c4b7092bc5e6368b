#include "scene/nff/polygon_run.h"

#include <cassert>
#include <utility>

namespace postlens {

PolygonFault PolygonRun::add(std::span<const glm::dvec3> corners, std::span<const glm::dvec3> normals) {
    assert(normals.empty() || normals.size() == corners.size());
    const Triangulation cut = triangulate(corners);
    if (cut.fault != PolygonFault::none) return cut.fault;
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    const glm::uvec3 t0 = cut.triangles.front();
    const glm::dvec3 face =
        glm::normalize(glm::cross(corners[t0.y] - corners[t0.x], corners[t0.z] - corners[t0.x]));
    for (std::size_t i = 0; i < corners.size(); ++i) {
        mesh_.positions.emplace_back(corners[i]);
        const double length = normals.empty() ? 0 : glm::length(normals[i]);
        mesh_.normals.emplace_back(length > 0 ? normals[i] / length : face);
    }
    for (const glm::uvec3& t : cut.triangles) mesh_.triangles.push_back(t + first);
    has_normals_ = has_normals_ || !normals.empty();
    return PolygonFault::none;
}

Mesh PolygonRun::take() {
    if (!has_normals_) mesh_.normals.clear();
    has_normals_ = false;
    return std::exchange(mesh_, {});
}

}  // namespace postlens
