// Collects polygons into one mesh.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "scene/scene.h"
#include "scene/triangulate.h"

namespace postlens {

/// Collects polygons that share a material. Corners are not shared between polygons.
class PolygonRun {
  public:
    [[nodiscard]] bool empty() const { return mesh_.triangles.empty(); }
    /// Adds a polygon with at least 3 corners, unless it has a fault. `normals`: one per corner, of any
    /// length, or empty for a flat polygon; a normal of length 0 is taken as the polygon's own.
    PolygonFault add(std::span<const glm::dvec3> corners, std::span<const glm::dvec3> normals);
    /// The mesh, with normals if any polygon had them; the run is empty afterwards.
    [[nodiscard]] Mesh take();

  private:
    Mesh mesh_;
    bool has_normals_ = false;
};

}  // namespace postlens
