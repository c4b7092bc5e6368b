// Closed convex curves as polygons: the rims of apertures.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace postlens {

/// Corners of a convex polygon, in order of growing angle from x to y.
using Outline = std::vector<glm::dvec2>;

/// A circle of radius 1 whose polygon has its area: the chords lie within `tolerance` of the circle.
[[nodiscard]] Outline circle_outline(double tolerance);

/// A regular polygon of `blades` sides, 3 or more, with its corners on the unit circle, one of them at
/// `rotation_deg` from x towards y. `roundness` bends its sides outwards, as arcs through the same corners:
/// 0 straight, 1 the circle itself. Chords lie within `tolerance` of the arcs.
[[nodiscard]] Outline blades_outline(int blades, double rotation_deg, double roundness, double tolerance);

/// What two of them have in common; empty where that is nothing.
[[nodiscard]] Outline intersection(const Outline& a, const Outline& b);

/// Not negative for the order of corners that Outline asks for.
[[nodiscard]] double area(const Outline& outline);

}  // namespace postlens
