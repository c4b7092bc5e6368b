// What an aperture lets through.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace postlens {

/// Transmission of an aperture over x, y in [-1, 1]: 1 is half the diameter D that u and v are made with, x
/// to the right and y down as on the raster. The share of the light (not of the amplitude) that passes, 0
/// to 1.
using Transmission = std::function<double(double x, double y)>;

[[nodiscard]] Transmission circular_aperture();

/// 1 inside the polygon, any number of turns of its outline counted odd-even. Throws Error(wrong_arguments)
/// for fewer than three corners and for corners outside of [-1, 1].
[[nodiscard]] Transmission polygon_aperture(std::vector<glm::dvec2> corners);

/// A picture laid over [-1, 1]^2, its longer side filling it, row by row from the top; linear between the
/// middles of pixels, 0 outside. Throws Error(wrong_arguments) for values outside of [0, 1] or not numbers,
/// for sizes that do not fit the values and for a picture that lets nothing through.
[[nodiscard]] Transmission picture_aperture(int width, int height, std::vector<float> values);

}  // namespace postlens
