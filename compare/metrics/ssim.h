// Structural similarity (SSIM) of two images.
#pragma once

#include <vector>

#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"

namespace postlens {

/// Computes the SSIM [wang2004, eq. 13] of two encoded images of the same size, per pixel, from the Rec.709
/// luma.
///
/// The outer 5 px are NaN, because the window crosses the border there. Pixels with `usable` 0 are replaced
/// by black in both images.
[[nodiscard]] std::vector<float> ssim_map(const Image& a_encoded, const Image& b_encoded,
                                          const PixelMask& usable);

}  // namespace postlens
