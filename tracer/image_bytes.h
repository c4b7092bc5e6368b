// Pictures that stand in memory as the bytes of an image file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tracer/texture.h"

namespace postlens {

/// The values of an image file, four to a pixel (red, green, blue, alpha), top row first, as the file has
/// them: 0 to 1 of integer formats, without any transfer curve undone. A missing alpha is 1, grey counts for
/// all three colours.
struct RawImage {
    int width = 0, height = 0;
    std::vector<float> rgba;
    bool has_alpha = false;
};

/// Largest picture that is decoded, pixels: 1 GiB of RawImage.
inline constexpr double most_image_pixels = 1 << 26;

/// Decodes a file of any format that OpenImageIO reads from memory (PNG, JPEG, ...). `name` is for errors.
/// Throws Error(invalid_input), also for a picture of more than most_image_pixels and for values that are not
/// finite.
[[nodiscard]] RawImage decode_image(std::string_view bytes, const std::string& name);

/// As a texture whose colours are sRGB in the file, with scene-linear ones.
[[nodiscard]] ImageTexture colour_image(const RawImage& raw);

/// The mean of one channel (0 to 3) as the file has it.
[[nodiscard]] double channel_mean(const RawImage& raw, std::size_t channel);

}  // namespace postlens
