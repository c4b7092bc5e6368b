// Collects polygons into one mesh.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "scene/scene.h"
#include "scene/triangulate.h"

namespace postlens {

/// Collects polygons of one material into a mesh. The polygons do not share corners.
class PolygonRun {
  public:
    [[nodiscard]] bool empty() const { return mesh_.triangles.empty(); }
    /// Adds a polygon with at least 3 corners. If it has a fault, returns the fault and adds nothing.
    /// `normals` has one vector per corner, of any length, or is empty for a flat polygon.
    /// A normal of length 0 is replaced by that of the polygon.
    PolygonFault add(std::span<const glm::dvec3> corners, std::span<const glm::dvec3> normals);
    /// Returns the collected mesh and starts a new one. It has vertex normals if any of its polygons has.
    [[nodiscard]] Mesh take();

  private:
    Mesh mesh_;
    bool has_normals_ = false;
};

}  // namespace postlens
