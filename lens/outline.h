// Polygons for closed convex curves, such as the rims of apertures.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace postlens {

/// The corners of a convex polygon, in the order of a rotation from the x axis to the y axis.
using Outline = std::vector<glm::dvec2>;

/// Returns a polygon that has the same area as the unit circle. The distance of its sides from the circle is
/// at most `tolerance`.
[[nodiscard]] Outline circle_outline(double tolerance);

/// Returns a regular polygon of `blades` sides, 3 or more. Its corners lie on the unit circle. One corner is
/// at the angle `rotation_deg` from x towards y. `roundness` turns the sides into arcs through the same
/// corners: 0 gives straight sides, and 1 gives the circle. The arcs are approximated by chords within
/// `tolerance`.
[[nodiscard]] Outline blades_outline(int blades, double rotation_deg, double roundness, double tolerance);

/// Returns the intersection of two outlines. It is empty if they do not overlap.
[[nodiscard]] Outline intersection(const Outline& a, const Outline& b);

/// Returns the signed area. It is not negative if the corners are in the order that Outline requires.
[[nodiscard]] double area(const Outline& outline);

}  // namespace postlens
