// Structural similarity (SSIM) of two images.
#pragma once

#include <vector>

#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"

namespace postlens {

/// SSIM [wang2004, eq. 13] of two encoded images of one size, for the Rec.709 luma of the sRGB values:
/// Gaussian window of 11 x 11 pixels with standard deviation 1.5 px, K1 = 0.01, K2 = 0.03, range 1. One value
/// per pixel; NaN in the outer 5 pixels, where the window would reach beyond the image, so that all windows
/// are complete as in the paper. Where `usable` is 0, both images count as black. Equal windows give
/// exactly 1.
[[nodiscard]] std::vector<float> ssim_map(const Image& a_encoded, const Image& b_encoded,
                                          const PixelMask& usable);

}  // namespace postlens
