// The error of a pixel whose colour is estimated from its surroundings.
#pragma once

#include <vector>

#include "pictures/image.h"

namespace postlens {

/// For each pixel, the variance of the image (sRGB values, mean over channels) within a square of 65 px. The
/// result is bit-identical for any number of threads.
[[nodiscard]] std::vector<float> local_contrast(const Image& image);

/// Expected squared error (sRGB values) of a pixel if a share of its light is replaced by light of its
/// surroundings. `variance` is the variance of the surroundings' values.
[[nodiscard]] inline double filled_in_error(double unknown_share, double variance) {
    return unknown_share * unknown_share * variance;
}
/// Expected squared error of a pixel if a part of its radiance, `light` (sRGB values), is reprojected to a
/// wrong position. On average half of this part still reaches the right pixel, so the error is a quarter of
/// the square of `light`.
[[nodiscard]] inline double misplaced_error(double light) {
    return light * light / 4;
}

}  // namespace postlens
