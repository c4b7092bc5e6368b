// Drawings of lenses: the cross-section with its rays, spot diagrams, curves over the field.
#pragma once

#include <string>
#include <vector>

#include "compare/drawing/drawing.h"
#include "lens/traced/lens_section.h"

namespace postlens {

/// The meridional section, with the scene on the left. Ticks on the axis mark the pupils.
[[nodiscard]] Drawing draw_section(const LensSection& section, const Prescription& lens,
                                   const TracedLens& traced);

struct Spot {
    std::string title;
    std::vector<glm::dvec2> points_mm;  ///< positions in the upright image: x to the right, y up
    double rms_mm = 0;
};
/// Spot diagrams side by side, at a common scale that a scale bar shows.
[[nodiscard]] Drawing draw_spots(const std::vector<Spot>& spots);

struct Curve {
    std::string title, unit;
    std::vector<double> x, y;
};
/// Plots the curves one below the other, over a common x axis.
[[nodiscard]] Drawing draw_curves(const std::vector<Curve>& curves, const std::string& x_title);

}  // namespace postlens
