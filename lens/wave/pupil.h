// Transmission of apertures as functions.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace postlens {

/// Transmission of an aperture over x, y in [-1, 1], in units of half the diameter D in u and v; x to the
/// right and y down as on the raster. The value is the share of intensity (not amplitude) that passes, 0
/// to 1.
using Transmission = std::function<double(double x, double y)>;

[[nodiscard]] Transmission circular_aperture();

/// 1 inside the polygon by the even-odd rule. Throws Error(wrong_arguments) for fewer than three corners and
/// for corners outside [-1, 1].
[[nodiscard]] Transmission polygon_aperture(std::vector<glm::dvec2> corners);

/// Transmission from an image, row by row from the top, whose longer side spans [-1, 1]. Bilinear between
/// pixel centres, 0 outside. Throws Error(wrong_arguments) for values outside [0, 1] or not numbers, for
/// sizes that do not match the number of values and for an image that transmits nothing.
[[nodiscard]] Transmission picture_aperture(int width, int height, std::vector<float> values);

}  // namespace postlens
