// Draws a map that shows where two images differ.
#pragma once

#include "pictures/image.h"

namespace postlens {

/// Limits of the colour scale of an error map, which shows the error of each pixel as a colour. The scale is
/// logarithmic. The limits are stated in steps of 8-bit sRGB (1/255 of the range). They are the same for all
/// maps, so that maps can be compared.
inline constexpr double map_least_steps = 0.1, map_greatest_steps = 255;

/// Returns the size, in px, of the image that `error_map` draws for two images of the size `pictures`. It is
/// higher than these because of a legend, which shows the error that each colour means. If they are narrow,
/// it is also wider.
[[nodiscard]] ImageSize error_map_size(ImageSize pictures);

/// Draws each pixel's largest channel difference in sRGB on a logarithmic scale, with a legend. NaN and
/// infinity are magenta.
///
/// Both images must have the same size. Returns scene-linear values for `write_image`.
[[nodiscard]] Image error_map(const Image& image, const Image& reference);

}  // namespace postlens
