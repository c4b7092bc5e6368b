// Image that shows where two images differ.
#pragma once

#include "pictures/image.h"

namespace postlens {

/// Limits of the map's logarithmic scale, in 8-bit steps. They are the same for every map, so that maps can
/// be compared with each other.
inline constexpr double map_least_steps = 0.1, map_greatest_steps = 255;

/// Size of the `error_map` for images of this size: the legend adds height, and width if the image is narrow.
[[nodiscard]] ImageSize error_map_size(ImageSize pictures);

/// Shows each pixel's largest channel difference, of clamped sRGB values, on a logarithmic scale. The colours
/// are those of viridis, which are perceptually uniform and keep their order in grey and for colour-blind
/// readers. Magenta marks pixels in which either image has a NaN or an infinity. The map is at the top left;
/// below it is a legend with numbers. Scene-linear, for `write_image`. The sizes must agree.
[[nodiscard]] Image error_map(const Image& image, const Image& reference);

}  // namespace postlens
