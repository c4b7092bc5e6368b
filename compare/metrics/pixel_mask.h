// Masks that select the pixels to compare.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// One entry per pixel, row by row: 1 if the pixel is used to compute errors, 0 if not.
using PixelMask = std::vector<std::uint8_t>;

/// Returns a mask of the pixels whose three channels are finite.
[[nodiscard]] PixelMask finite_pixels(const Image& image);
/// Returns a mask of the pixels that both masks select. The masks must have the same size.
[[nodiscard]] PixelMask both(const PixelMask& a, const PixelMask& b);
[[nodiscard]] std::size_t count(const PixelMask& mask);

/// Clamps every value to 0..1 and applies the sRGB curve, like an 8-bit image without rounding. A NaN becomes
/// 0.
[[nodiscard]] Image encoded_srgb(const Image& image);

/// Returns a mask of the pixels that the lens or the shutter changes: those in which a channel of the
/// sRGB-encoded pinhole image and of the reference differs by more than 1/255. Only pixels in the mask
/// `counted` are included. The images must have the same size.
[[nodiscard]] PixelMask affected_pixels(const Image& pinhole_encoded, const Image& reference_encoded,
                                        const PixelMask& counted);

/// Returns the sum of row(y) for y in [0, rows). Rows are evaluated in parallel but added in order, so the
/// sum is bit-identical for any number of threads.
[[nodiscard]] double sum_of_rows(int rows, const std::function<double(std::size_t y)>& row);

/// Returns the mean of `map` over the pixels that `mask` counts, skipping NaN. Returns NaN if nothing is
/// left.
[[nodiscard]] double mean_over(const std::vector<float>& map, int width, const PixelMask& mask);

}  // namespace postlens
