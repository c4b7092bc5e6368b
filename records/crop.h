// The part of a picture that is wanted.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "records/image.h"

namespace postlens {

/// Throws Error(wrong_arguments) for a crop that is not within a picture of width x height, or is empty.
void check_crop(const std::optional<Crop>& crop, int width, int height);

/// How many pixels are wanted of a picture of width x height.
[[nodiscard]] std::size_t wanted_pixels(const std::optional<Crop>& crop, int width, int height);

/// That part of a picture, or all of it. Throws as check_crop does.
[[nodiscard]] Image cut(const Image& picture, const std::optional<Crop>& crop);

/// The same of values that there is one of for each pixel, row by row, `width` a row.
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

}  // namespace postlens
