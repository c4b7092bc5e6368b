// Draws a map that shows where two images differ.
#pragma once

#include "pictures/image.h"

namespace postlens {

/// Limits of the map's logarithmic scale, in 8-bit steps. They are the same for all maps, so that maps can be
/// compared with each other.
inline constexpr double map_least_steps = 0.1, map_greatest_steps = 255;

/// Returns the size of the map that `error_map` draws for images of size `pictures`. The legend makes the map
/// higher and, for narrow images, wider.
[[nodiscard]] ImageSize error_map_size(ImageSize pictures);

/// Draws the largest channel difference of each pixel on a logarithmic scale. Differences are those of sRGB
/// values clamped to 0..1. The colours are those of viridis, which keep their order in greyscale and for
/// colour-blind readers. A pixel is magenta if either image has a NaN or an infinity there. A legend with
/// numbers is added below the map. Returns scene-linear values for `write_image`. Both images must have the
/// same size.
[[nodiscard]] Image error_map(const Image& image, const Image& reference);

}  // namespace postlens
