// 8-bit images, and their encoding as PNG files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// An 8-bit sRGB image. Pixels have three bytes and are stored row by row, top row first.
struct EncodedPicture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
    std::optional<double> exposure_stops{};  ///< as in Image; stored in the file if known
    std::string made_by{};                   ///< as in Image

    EncodedPicture() = default;
    EncodedPicture(int w, int h)
        : width(w), height(h), rgb(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * 3) {}
    [[nodiscard]] std::uint8_t* row(int y) {
        return rgb.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width) * 3;
    }
    [[nodiscard]] const std::uint8_t* row(int y) const { return const_cast<EncodedPicture*>(this)->row(y); }
};

/// Returns 255 * srgb_from_linear(v), rounded. It uses a table, because power functions are slow.
[[nodiscard]] std::uint8_t srgb_byte(float v);

/// Clamps scene-linear values to 0..1 and encodes them as sRGB bytes.
[[nodiscard]] EncodedPicture encoded_8bit(const Image& image);

/// Returns the bytes of the PNG file that `write_image` would write. Throws Error(cannot_write), with the
/// file name `shown_name`, if libpng fails.
[[nodiscard]] std::string png_file(const EncodedPicture& picture, const std::string& shown_name);

}  // namespace postlens
