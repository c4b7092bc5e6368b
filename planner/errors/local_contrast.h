// Estimates two errors of a pixel. Light that is not recorded in the sample file is replaced by colours from
// around the pixel, so its error depends on the contrast there. Light that is reprojected to a wrong position
// also causes an error.
#pragma once

#include <vector>

#include "pictures/image.h"

namespace postlens {

/// Returns the variance of the sRGB values in the square of 65 x 65 px around each pixel, as a mean over
/// channels. The result is bit-identical for any number of threads.
[[nodiscard]] std::vector<float> local_contrast(const Image& image);

/// Returns the expected squared error of a pixel's sRGB value if the fraction `unknown_share` of its light is
/// not recorded in the sample file. This light is replaced by colours from around the pixel. So its error
/// depends on `variance`, the variance of the sRGB values around the pixel.
[[nodiscard]] inline double filled_in_error(double unknown_share, double variance) {
    return unknown_share * unknown_share * variance;
}
/// Returns the expected squared error of a pixel if some of its light is reprojected to a wrong position.
/// `light` is this light as an sRGB value. On average, half of it is assumed to reach the right pixel
/// nevertheless, so the error is light / 2.
[[nodiscard]] inline double misplaced_error(double light) {
    return light * light / 4;
}

}  // namespace postlens
