// Structural similarity (SSIM) of two images.
#pragma once

#include <vector>

#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"

namespace postlens {

/// Computes the SSIM [wang2004, eq. 13] of two encoded images of the same size. Returns one value per pixel.
/// SSIM is computed from the Rec.709 luma of the sRGB values, with K1 = 0.01, K2 = 0.03 and a range of 1. The
/// Gaussian window has 11 x 11 pixels and a standard deviation of 1.5 px. The outer 5 pixels are NaN, because
/// a window around them would cross the border. Both images are treated as black where `usable` is 0. The
/// SSIM of equal windows is exactly 1.
[[nodiscard]] std::vector<float> ssim_map(const Image& a_encoded, const Image& b_encoded,
                                          const PixelMask& usable);

}  // namespace postlens
