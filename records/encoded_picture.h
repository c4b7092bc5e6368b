// A picture as 8-bit files hold it, and its way into a PNG file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "records/image.h"

namespace postlens {

/// Row-major, top row first, three bytes a pixel, with the sRGB curve.
struct EncodedPicture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
    std::optional<double> exposure_stops{};  ///< as of Image; kept in the file where it is known

    EncodedPicture() = default;
    EncodedPicture(int w, int h)
        : width(w), height(h), rgb(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 3) {}
    [[nodiscard]] std::uint8_t* row(int y) {
        return rgb.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width) * 3;
    }
    [[nodiscard]] const std::uint8_t* row(int y) const { return const_cast<EncodedPicture*>(this)->row(y); }
};

/// 255 srgb_from_linear(v), rounded, without its power.
[[nodiscard]] std::uint8_t srgb_byte(float v);

/// Of scene-linear values, clamped to 0..1.
[[nodiscard]] EncodedPicture encoded_8bit(const Image& image);

/// The bytes of a PNG file, as `write_image` writes one of the same picture. Throws Error(cannot_write), in
/// which `shown_name` stands for the file, where the library refuses.
[[nodiscard]] std::string png_file(const EncodedPicture& picture, const std::string& shown_name);

}  // namespace postlens
