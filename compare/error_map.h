// A picture of where two pictures differ.
#pragma once

#include "records/image.h"

namespace postlens {

/// What the scale of the map covers: 0.1 of an 8-bit step to all 255 of them, logarithmic, the same for every
/// map, so that maps can be held against each other.
inline constexpr double map_least_steps = 0.1, map_greatest_steps = 255;

/// The size of `error_map` for pictures of this size: the pictures' height and a legend, and their width or
/// what the legend needs.
[[nodiscard]] ImageSize error_map_size(ImageSize pictures);

/// The largest channel difference of each pixel, of clamped sRGB-encoded values, on a logarithmic scale in
/// the colours of viridis, which are perceptually uniform and keep their order in grey and for the
/// colour-blind; magenta where either picture has a NaN or an infinity. The map stands at the top left, below
/// it a legend with numbers. Scene-linear, to be written with `write_image`. Sizes must agree.
[[nodiscard]] Image error_map(const Image& image, const Image& reference);

}  // namespace postlens
