// Crops images.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// Throws Error(wrong_arguments) if the crop is empty or extends beyond an image of width x height.
void check_crop(const std::optional<Crop>& crop, int width, int height);

/// Returns the number of pixels in the crop, or in the whole image if there is no crop.
[[nodiscard]] std::size_t wanted_pixels(const std::optional<Crop>& crop, int width, int height);

/// Returns the cropped image, or the whole image if there is no crop. Throws the errors of check_crop.
[[nodiscard]] Image cut(const Image& picture, const std::optional<Crop>& crop);

/// Crops an array that has one value per pixel, row by row, with `width` values per row.
template <typename Value>
[[nodiscard]] std::vector<Value> cut(const std::vector<Value>& of_pixels, int width,
                                     const std::optional<Crop>& crop) {
    if (!crop || of_pixels.empty()) return of_pixels;
    std::vector<Value> out;
    out.reserve(static_cast<std::size_t>(crop->width) * static_cast<std::size_t>(crop->height));
    for (int y = crop->y; y < crop->y + crop->height; ++y) {
        const auto row = of_pixels.begin() + static_cast<std::ptrdiff_t>(y) * width + crop->x;
        out.insert(out.end(), row, row + crop->width);
    }
    return out;
}

/// Returns the mean of `of_pixels`, an array with one value per pixel, within the rectangle `crop` (default:
/// the whole image). Returns 0 if there are no pixels.
template <typename Value>
[[nodiscard]] double mean_of(const std::vector<Value>& of_pixels, int width,
                             const std::optional<Crop>& crop) {
    const std::vector<Value> wanted = cut(of_pixels, width, crop);
    return std::accumulate(wanted.begin(), wanted.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(wanted.size(), 1));
}

}  // namespace postlens
