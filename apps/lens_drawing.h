// Figures of lenses: the cross-section with its rays, spot diagrams, curves over the field.
#pragma once

#include <string>
#include <vector>

#include "compare/drawing.h"
#include "lens/prescription/lens_section.h"

namespace postlens {

/// The cut through the axis, the scene on the left; pupils marked with ticks on the axis.
[[nodiscard]] Drawing draw_section(const LensSection& section, const Prescription& lens,
                                   const TracedLens& traced);

struct Spot {
    std::string title;
    std::vector<glm::dvec2> points_mm;  ///< upright: x to the right, y up as in the picture
    double rms_mm = 0;
};
/// Side by side at one scale, which a bar tells.
[[nodiscard]] Drawing draw_spots(const std::vector<Spot>& spots);

struct Curve {
    std::string title, unit;
    std::vector<double> x, y;
};
/// One below the other over the same x.
[[nodiscard]] Drawing draw_curves(const std::vector<Curve>& curves, const std::string& x_title);

}  // namespace postlens
