// Structural similarity (SSIM) of two images.
#pragma once

#include <vector>

#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"

namespace postlens {

/// Computes the SSIM [wang2004, eq. 13] of two encoded images of the same size, for the Rec.709 luma of the
/// sRGB values. The Gaussian window has 11 x 11 pixels and a standard deviation of 1.5 px; K1 = 0.01, K2 =
/// 0.03, range 1. Returns one value per pixel. The outer 5 pixels are NaN, so that all windows are complete,
/// as in the paper. Where `usable` is 0, both images are treated as black. Equal windows have a SSIM of
/// exactly 1.
[[nodiscard]] std::vector<float> ssim_map(const Image& a_encoded, const Image& b_encoded,
                                          const PixelMask& usable);

}  // namespace postlens
