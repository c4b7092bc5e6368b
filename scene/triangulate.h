// Divides polygons into triangles.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace postlens {

/// Greatest number of corners of a polygon that readers accept: the time of ear clipping grows with its
/// square.
inline constexpr std::size_t largest_polygon = 4096;

enum class PolygonFault { none, no_area, crosses_itself };

struct Triangulation {
    std::vector<glm::uvec3> triangles;  ///< indices of corners, with the polygon's winding
    PolygonFault fault = PolygonFault::none;
};

/// Divides a simple polygon of at least 3 corners, convex or concave, flat or nearly flat (as projected along
/// its Newell normal). A convex polygon becomes a fan about its first corner; a concave one is divided by ear
/// clipping [meisters1975]. Collinear and repeated corners are allowed; triangles without area are left out.
/// `triangles` is empty if `fault` is set.
[[nodiscard]] Triangulation triangulate(std::span<const glm::dvec3> polygon);

}  // namespace postlens
