// Closed convex curves, such as the rims of apertures, as polygons.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace postlens {

/// Corners of a convex polygon, in the direction of rotation from the x axis to the y axis.
using Outline = std::vector<glm::dvec2>;

/// A polygon with the area of the unit circle. The distance of its sides from that circle is at most
/// `tolerance`.
[[nodiscard]] Outline circle_outline(double tolerance);

/// A regular polygon of `blades` sides, 3 or more. Its corners lie on the unit circle; one is at angle
/// `rotation_deg` from x towards y. `roundness` turns the sides into arcs through the same corners: 0 gives
/// straight sides, 1 the circle. The arcs are approximated by chords within `tolerance`.
[[nodiscard]] Outline blades_outline(int blades, double rotation_deg, double roundness, double tolerance);

/// Intersection of two outlines; empty if they do not overlap.
[[nodiscard]] Outline intersection(const Outline& a, const Outline& b);

/// Signed area: positive or 0 if the corners are in the order that Outline requires.
[[nodiscard]] double area(const Outline& outline);

}  // namespace postlens
