// Estimates the error of a pixel if part of its light is not recorded, or is reprojected to a wrong position.
#pragma once

#include <vector>

#include "pictures/image.h"

namespace postlens {

/// Returns the variance of the sRGB values in the square of 65 x 65 px around each pixel, as a mean over
/// channels. The result is bit-identical for any number of threads.
[[nodiscard]] std::vector<float> local_contrast(const Image& image);

/// Returns the expected squared error of a pixel's sRGB value if the fraction `unknown_share` of its light is
/// not recorded. Colours from around the pixel replace this light. `variance` is the variance of the sRGB
/// values around the pixel.
[[nodiscard]] inline double filled_in_error(double unknown_share, double variance) {
    return unknown_share * unknown_share * variance;
}
/// Returns the expected squared error of a pixel if its light (the sRGB value `light`) is reprojected to a
/// wrong position. Half of the light is assumed to reach the right pixel, so the pixel is wrong by light / 2.
[[nodiscard]] inline double misplaced_error(double light) {
    return light * light / 4;
}

}  // namespace postlens
