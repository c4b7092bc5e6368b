// Apertures as functions of the pupil position.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace postlens {

/// Transmittance of an aperture at x, y in [-1, 1], which are in units of the radius D/2 used in u and v. x
/// points right and y down, as on the raster. The value is the share of intensity (not of amplitude) that
/// passes, 0 to 1.
using Transmission = std::function<double(double x, double y)>;

[[nodiscard]] Transmission circular_aperture();

/// Transmittance 1 inside the polygon, by the even-odd rule, and 0 outside. Throws Error(wrong_arguments) for
/// fewer than three corners, or for corners outside [-1, 1].
[[nodiscard]] Transmission polygon_aperture(std::vector<glm::dvec2> corners);

/// Transmittance from an image, row by row from the top, whose longer side spans [-1, 1]. Values between
/// pixel centres are interpolated bilinearly; outside the image they are 0. Throws Error(wrong_arguments) for
/// a value outside [0, 1] or not-a-number, for an image that transmits no light, and unless there are width
/// times height values.
[[nodiscard]] Transmission picture_aperture(int width, int height, std::vector<float> values);

}  // namespace postlens
