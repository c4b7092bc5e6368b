// Drawings of lenses: cross-sections with rays, spot diagrams, and curves over the field of view.
#pragma once

#include <string>
#include <vector>

#include "compare/drawing/drawing.h"
#include "lens/traced/lens_section.h"

namespace postlens {

/// Draws a meridional section of the lens, with the scene on the left. Ticks on the axis mark the pupils.
[[nodiscard]] Drawing draw_section(const LensSection& section, const Prescription& lens,
                                   const TracedLens& traced);

struct Spot {
    std::string title;
    std::vector<glm::dvec2> points_mm;  ///< positions in the upright image: x to the right, y up
    double rms_mm = 0;
};
/// Draws spot diagrams side by side. A scale bar shows their common scale.
[[nodiscard]] Drawing draw_spots(const std::vector<Spot>& spots);

struct Curve {
    std::string title, unit;
    std::vector<double> x, y;
};
/// Plots the curves one below the other, with a common x axis.
[[nodiscard]] Drawing draw_curves(const std::vector<Curve>& curves, const std::string& x_title);

}  // namespace postlens
