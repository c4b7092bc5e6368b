// Masks of the pixels that count, and operations over all pixels: encoding, sums and means.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// One entry per pixel, row-major: 1 where the pixel counts, else 0.
using PixelMask = std::vector<std::uint8_t>;

/// 1 where all three channels are finite.
[[nodiscard]] PixelMask finite_pixels(const Image& image);
/// 1 where both masks are 1. Their sizes must agree.
[[nodiscard]] PixelMask both(const PixelMask& a, const PixelMask& b);
[[nodiscard]] std::size_t count(const PixelMask& mask);

/// Clamps every value to 0..1 and applies the sRGB transfer curve, as for an 8-bit image but without
/// rounding. NaN becomes 0.
[[nodiscard]] Image encoded_srgb(const Image& image);

/// 1 where `counted` is 1 and any channel of the two encoded images differs by more than 1/255. The images
/// must have the same size.
[[nodiscard]] PixelMask affected_pixels(const Image& pinhole_encoded, const Image& reference_encoded,
                                        const PixelMask& counted);

/// Sum of row(y) for y in [0, rows). Rows are evaluated in parallel but added in order, so that the sum has
/// the same bits for any number of threads.
[[nodiscard]] double sum_of_rows(int rows, const std::function<double(std::size_t y)>& row);

/// Mean of a map, one value per pixel, over the pixels that `mask` counts and whose value is not NaN. The
/// mean is NaN if there are none.
[[nodiscard]] double mean_over(const std::vector<float>& map, int width, const PixelMask& mask);

}  // namespace postlens
