// Decodes image files that are held in memory.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/texture.h"

namespace postlens {

/// The values stored in an image file, four per pixel (red, green, blue, alpha), top row first. Integers are
/// scaled to 0 to 1. The transfer curve is not inverted. A missing alpha is 1; grey is copied to all three
/// colours.
struct RawImage {
    int width = 0, height = 0;
    std::vector<float> rgba;
    bool has_alpha = false;
};

/// Largest image that is decoded, pixels. Its RawImage needs 1 GiB.
inline constexpr double most_image_pixels = 1 << 26;

/// Decodes a PNG, JPEG or OpenEXR file. `name` is for error messages. Throws Error(invalid_input), also if
/// the image has more than most_image_pixels or if a value is not finite.
[[nodiscard]] RawImage decode_image(std::string_view bytes, const std::string& name);

/// Returns a texture with scene-linear colours. The stored values are interpreted as sRGB.
[[nodiscard]] ImageTexture colour_image(const RawImage& raw);

/// Returns the mean of the scene-linear colours. The stored values are interpreted as sRGB.
[[nodiscard]] glm::dvec3 mean_colour(const RawImage& raw);

/// Returns the mean of the stored values of one channel (0 to 3).
[[nodiscard]] double channel_mean(const RawImage& raw, std::size_t channel);

}  // namespace postlens
