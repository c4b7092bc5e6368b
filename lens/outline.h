// Closed convex curves as polygons: the rims of apertures.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace postlens {

/// Corners of a convex polygon, in order of growing angle from x to y.
using Outline = std::vector<glm::dvec2>;

/// A polygon with the area of the unit circle, whose sides lie within `tolerance` of that circle.
[[nodiscard]] Outline circle_outline(double tolerance);

/// A regular polygon of `blades` sides, 3 or more, with its corners on the unit circle, one of them at
/// `rotation_deg` from x towards y. `roundness` turns the sides into arcs through the same corners: 0 gives
/// straight sides, 1 the circle. Chords lie within `tolerance` of the arcs.
[[nodiscard]] Outline blades_outline(int blades, double rotation_deg, double roundness, double tolerance);

/// Intersection of two outlines; empty if they do not overlap.
[[nodiscard]] Outline intersection(const Outline& a, const Outline& b);

/// Signed area: not negative for the order of corners that Outline defines.
[[nodiscard]] double area(const Outline& outline);

}  // namespace postlens
