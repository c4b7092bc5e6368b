// Polygons to triangles.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace postlens {

/// A polygon with more corners than this is refused by the readers: clipping ears takes time with their
/// square.
inline constexpr std::size_t largest_polygon = 4096;

enum class PolygonFault { none, no_area, crosses_itself };

struct Triangulation {
    std::vector<glm::uvec3> triangles;  ///< indices into the polygon, in its own turning direction
    PolygonFault fault = PolygonFault::none;
};

/// Splits a simple polygon of at least 3 corners, convex or concave, flat or nearly so (seen along its Newell
/// normal). A convex one becomes a fan about its first corner; else ears are clipped [meisters1975]. Corners
/// on a straight line and repeated ones are allowed; triangles without area are left out. `triangles` is
/// empty where `fault` is set.
[[nodiscard]] Triangulation triangulate(std::span<const glm::dvec3> polygon);

}  // namespace postlens
