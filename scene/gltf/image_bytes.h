// Decodes image files that are held in memory.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/texture.h"

namespace postlens {

/// The stored values of an image file, four per pixel (red, green, blue, alpha), top row first. Values of
/// integer formats are scaled to 0 to 1; the transfer curve is not undone. A missing alpha is 1; grey is
/// copied to all three colours.
struct RawImage {
    int width = 0, height = 0;
    std::vector<float> rgba;
    bool has_alpha = false;
};

/// Largest image that is decoded, pixels. Its RawImage takes 1 GiB.
inline constexpr double most_image_pixels = 1 << 26;

/// Decodes a PNG, JPEG or OpenEXR file. `name` is for error messages. Throws Error(invalid_input), also for
/// an image of more than most_image_pixels and for values that are not finite.
[[nodiscard]] RawImage decode_image(std::string_view bytes, const std::string& name);

/// A texture with scene-linear colours. The stored values are taken as sRGB.
[[nodiscard]] ImageTexture colour_image(const RawImage& raw);

/// The mean of the stored values of one channel (0 to 3).
[[nodiscard]] double channel_mean(const RawImage& raw, std::size_t channel);

}  // namespace postlens
