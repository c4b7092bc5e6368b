// Structural similarity (SSIM) of two images.
#pragma once

#include <vector>

#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"

namespace postlens {

/// Computes the SSIM [wang2004, eq. 13] of two encoded images of the same size, per pixel, with K1 = 0.01, K2
/// = 0.03 and range 1. It uses the Rec.709 luma.
///
/// The window is an 11 x 11 px Gaussian with a standard deviation of 1.5 px, so the outer 5 px are NaN. Where
/// `usable` is 0, both images are black.
[[nodiscard]] std::vector<float> ssim_map(const Image& a_encoded, const Image& b_encoded,
                                          const PixelMask& usable);

}  // namespace postlens
