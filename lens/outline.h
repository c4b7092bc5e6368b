// Polygons for closed convex curves, such as the rims of apertures.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace postlens {

/// Corners of a convex polygon, in the order of a rotation from the x axis to the y axis.
using Outline = std::vector<glm::dvec2>;

/// Returns a polygon with the area of the unit circle. Its sides are within `tolerance` of the circle.
[[nodiscard]] Outline circle_outline(double tolerance);

/// Returns a regular polygon of 3 or more `blades`, inscribed in the unit circle. One corner is at the angle
/// `rotation_deg` from x towards y.
///
/// `roundness` bends the sides into arcs, from 0 (straight) to 1 (circle). Chords approximate arcs within
/// `tolerance`.
[[nodiscard]] Outline blades_outline(int blades, double rotation_deg, double roundness, double tolerance);

/// Returns the intersection of two outlines. It is empty if they do not overlap.
[[nodiscard]] Outline intersection(const Outline& a, const Outline& b);

/// Returns the signed area of a polygon. It is positive if the corners are in the order of a rotation from
/// the x axis towards the y axis, as in an Outline. Otherwise, it is negative.
[[nodiscard]] double area(const Outline& outline);

}  // namespace postlens
