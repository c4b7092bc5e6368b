// Draws a map that shows where two images differ.
#pragma once

#include "pictures/image.h"

namespace postlens {

/// The error map shows errors as colours, on a logarithmic scale with these limits in 8-bit steps (1/255 in
/// sRGB). The limits are fixed, so that maps can be compared.
inline constexpr double map_least_steps = 0.1, map_greatest_steps = 255;

/// Returns the size of the `error_map` of images of size `pictures`. The legend makes it higher and, for
/// narrow images, wider.
[[nodiscard]] ImageSize error_map_size(ImageSize pictures);

/// Draws each pixel's largest channel difference in sRGB on a logarithmic scale, with a legend. NaN and
/// infinity are magenta.
///
/// Both images must have the same size. Returns scene-linear values for `write_image`.
[[nodiscard]] Image error_map(const Image& image, const Image& reference);

}  // namespace postlens
