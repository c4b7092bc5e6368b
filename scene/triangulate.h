// Divides polygons into triangles.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace postlens {

/// Greatest number of corners of a polygon. The time for ear clipping grows with its square.
inline constexpr std::size_t largest_polygon = 4096;

enum class PolygonFault { none, no_area, crosses_itself };

struct Triangulation {
    std::vector<glm::uvec3> triangles;  ///< indices of corners; they wind like the polygon
    PolygonFault fault = PolygonFault::none;
};

/// Divides a polygon into triangles. The polygon must be simple (its sides do not cross) and have at least 3
/// corners. It may be concave and need not be flat. Its corners may be collinear or repeated. Triangles
/// without area are omitted. A convex polygon becomes a fan of triangles about its first corner. Others are
/// divided by ear clipping [meisters1975].
///
/// If the result's `fault` is not `none`, its `triangles` is empty.
[[nodiscard]] Triangulation triangulate(std::span<const glm::dvec3> polygon);

}  // namespace postlens
