// Image that shows where two images differ.
#pragma once

#include "pictures/image.h"

namespace postlens {

/// Limits of the logarithmic scale of the map, in 8-bit steps. They are constant, so that maps can be
/// compared with each other.
inline constexpr double map_least_steps = 0.1, map_greatest_steps = 255;

/// Returns the size of the image that `error_map` makes of images of size `pictures`. The legend adds to the
/// height, and to the width of narrow images.
[[nodiscard]] ImageSize error_map_size(ImageSize pictures);

/// Shows the largest channel difference of each pixel on a logarithmic scale, for sRGB values clamped to
/// 0..1. The colours are those of viridis, which is perceptually uniform and keeps its order in greyscale and
/// for colour-blind readers. Magenta marks pixels in which either image has a NaN or an infinity. The map is
/// at the top left, above a legend with numbers. The result is scene-linear, for `write_image`. The images
/// must have the same size.
[[nodiscard]] Image error_map(const Image& image, const Image& reference);

}  // namespace postlens
