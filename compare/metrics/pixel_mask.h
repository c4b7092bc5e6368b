// Masks that select the pixels to compare, and functions that encode, add up or average pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// One entry per pixel, row by row: 1 if the pixel counts, 0 if it does not.
using PixelMask = std::vector<std::uint8_t>;

/// Returns a mask that is 1 where all three channels are finite.
[[nodiscard]] PixelMask finite_pixels(const Image& image);
/// Returns a mask that is 1 where both masks are 1. The masks must have the same size.
[[nodiscard]] PixelMask both(const PixelMask& a, const PixelMask& b);
[[nodiscard]] std::size_t count(const PixelMask& mask);

/// Clamps every value to 0..1 and applies the sRGB transfer curve. This is the encoding of an 8-bit image,
/// but without rounding. A NaN becomes 0.
[[nodiscard]] Image encoded_srgb(const Image& image);

/// Returns a mask that is 1 where `counted` is 1 and any channel differs between the two encoded images by
/// more than 1/255. The images must have the same size.
[[nodiscard]] PixelMask affected_pixels(const Image& pinhole_encoded, const Image& reference_encoded,
                                        const PixelMask& counted);

/// Returns the sum of row(y) for y in [0, rows). Rows are evaluated in parallel but added in order. The sum
/// is therefore bit-identical for any number of threads.
[[nodiscard]] double sum_of_rows(int rows, const std::function<double(std::size_t y)>& row);

/// Returns the mean of `map` (one value per pixel) over the pixels that `mask` counts. NaN values are
/// skipped. Returns NaN if no values are left.
[[nodiscard]] double mean_over(const std::vector<float>& map, int width, const PixelMask& mask);

}  // namespace postlens
