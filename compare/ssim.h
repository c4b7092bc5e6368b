// Structural similarity of two pictures.
#pragma once

#include <vector>

#include "compare/pixel_mask.h"
#include "records/image.h"

namespace postlens {

/// SSIM [wang2004, eq. 13] of two encoded pictures of one size, for the Rec.709 luma of the encoded values:
/// Gaussian window of 11 x 11 pixels with standard deviation 1.5, K1 = 0.01, K2 = 0.03, range 1. One value a
/// pixel; NaN where the window would leave the picture (the outer 5 pixels), so that windows are whole as in
/// the paper. Where `usable` is 0 both pictures are taken as black. Equal windows give exactly 1.
[[nodiscard]] std::vector<float> ssim_map(const Image& a_encoded, const Image& b_encoded,
                                          const PixelMask& usable);

}  // namespace postlens
