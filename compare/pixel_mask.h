// Which pixels count, and what is done with all of them: encoding, means.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "records/image.h"

namespace postlens {

/// One entry a pixel, row-major: 1 where it counts, else 0.
using PixelMask = std::vector<std::uint8_t>;

/// 1 where all three channels are finite.
[[nodiscard]] PixelMask finite_pixels(const Image& image);
/// 1 where both are; sizes must agree.
[[nodiscard]] PixelMask both(const PixelMask& a, const PixelMask& b);
[[nodiscard]] std::size_t count(const PixelMask& mask);

/// Every value clamped to 0..1 and taken through the sRGB transfer curve, as an 8-bit picture would hold it
/// but not rounded. NaN becomes 0.
[[nodiscard]] Image encoded_srgb(const Image& image);

/// 1 where any channel of two encoded pictures of one size differs by more than 1/255, and `counted` is 1.
[[nodiscard]] PixelMask affected_pixels(const Image& pinhole_encoded, const Image& reference_encoded,
                                        const PixelMask& counted);

/// The sum of row(y) for y in [0, rows): in parallel, added in one order, so with the same bits for any
/// number of threads.
[[nodiscard]] double sum_of_rows(int rows, const std::function<double(std::size_t y)>& row);

/// Mean of a map, one value a pixel, over the pixels that `mask` counts and that have a value; NaN stands for
/// none, in the map and in the result.
[[nodiscard]] double mean_over(const std::vector<float>& map, int width, const PixelMask& mask);

}  // namespace postlens
