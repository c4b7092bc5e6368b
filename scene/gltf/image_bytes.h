// Decodes image files that are held in memory.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/texture.h"

namespace postlens {

/// The values stored in an image file, four per pixel (red, green, blue, alpha), top row first.
/// Integers are scaled to 0..1. sRGB values are not linearised.
/// Grey is copied to all three colours. If the file has no alpha, it is 1.
struct RawImage {
    int width = 0, height = 0;
    std::vector<float> rgba;
    bool has_alpha = false;
};

/// Largest image that is decoded, in pixels. A RawImage has four floats for each pixel, so it then needs 1
/// GiB.
inline constexpr double most_image_pixels = 1 << 26;

/// Decodes a PNG, JPEG or OpenEXR file. Error messages call it `name`.
/// Throws Error(invalid_input) if it cannot be decoded, has more than most_image_pixels, or is not finite.
[[nodiscard]] RawImage decode_image(std::string_view bytes, const std::string& name);

/// Converts stored sRGB values to a texture with scene-linear colours.
[[nodiscard]] ImageTexture colour_image(const RawImage& raw);

/// Converts stored sRGB values to scene-linear colours and returns their mean.
[[nodiscard]] glm::dvec3 mean_colour(const RawImage& raw);

/// Returns the mean of the stored values of one channel (0 to 3).
[[nodiscard]] double channel_mean(const RawImage& raw, std::size_t channel);

}  // namespace postlens
