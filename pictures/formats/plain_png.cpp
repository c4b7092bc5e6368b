#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <png.h>
#include <string>
#include <utility>

#include "pictures/formats/plain_picture.h"

namespace postlens {
namespace {

using namespace std::string_view_literals;

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8U | static_cast<std::uint8_t>(bytes[at + k]);
    return value;
}

struct PlainPng {
    std::uint32_t width = 0, height = 0;
    bool grey = false;
    std::string exposure;  ///< postlens.exposure_stops; empty if there is none
    std::string made_by;   ///< postlens.made_by; empty if there is none
};

/// Reads a text chunk (tEXt) of a PNG file, `data`, which consists of a keyword and a text. If the keyword
/// equals `key`, sets `value` to the text.
void take_text(std::string_view data, std::string_view key, std::string& value) {
    if (data.starts_with(key) && data.substr(key.size()).starts_with('\0'))
        value = data.substr(key.size() + 1);
}

/// Reads the chunks (blocks of data) of a PNG file that precede the pixels, such as the image size and the
/// palette. Returns empty if the file is damaged, or if a chunk changes the meaning of the pixels in an
/// unsupported way.
std::optional<PlainPng> plain_png(std::string_view bytes) {
    constexpr std::string_view signature = "\x89PNG\r\n\x1A\n"sv;
    // PNG chunks that do not change the values of the pixels, such as texts and dates.
    constexpr std::array silent{"PLTE"sv, "sRGB"sv, "cHRM"sv, "pHYs"sv, "tEXt"sv, "zTXt"sv,
                                "iTXt"sv, "tIME"sv, "bKGD"sv, "sBIT"sv, "hIST"sv, "eXIf"sv};
    constexpr std::uint32_t gamma_of_srgb = 45455;
    if (!bytes.starts_with(signature)) return std::nullopt;
    PlainPng out;
    for (std::size_t at = signature.size();;) {
        if (bytes.size() - at < 12) return std::nullopt;
        const std::uint32_t size = big_endian(bytes, at);
        const std::string_view type = bytes.substr(at + 4, 4);
        if (type == "IDAT"sv) break;  // also if it is truncated: libpng reports that to PngReader
        if (size > bytes.size() - at - 12) return std::nullopt;
        const std::string_view data = bytes.substr(at + 8, size);
        if (type == "IHDR"sv) {
            if (size != 13 || out.width != 0) return std::nullopt;
            out.width = big_endian(data, 0);
            out.height = big_endian(data, 4);
            const int depth = data[8], colours = data[9];
            out.grey = colours == PNG_COLOR_TYPE_GRAY;
            const bool palette = colours == PNG_COLOR_TYPE_PALETTE && depth <= 8;
            const bool direct = (out.grey || colours == PNG_COLOR_TYPE_RGB) && depth == 8;
            if (!palette && !direct) return std::nullopt;
        } else if (type == "gAMA"sv) {
            if (size != 4 || big_endian(data, 0) != gamma_of_srgb) return std::nullopt;
        } else if (type == "oFFs"sv) {
            // OpenImageIO writes an oFFs chunk (image offset) into every PNG file. An offset of zero has no
            // effect.
            if (data != "\0\0\0\0\0\0\0\0\0"sv) return std::nullopt;
        } else if (std::find(silent.begin(), silent.end(), type) == silent.end()) {
            return std::nullopt;
        }
        if (type == "tEXt"sv) {
            take_text(data, exposure_attribute, out.exposure);
            take_text(data, made_by_attribute, out.made_by);
        }
        at += 12 + static_cast<std::size_t>(size);
    }
    constexpr std::uint32_t most = 1000000;  // libpng's own limit
    if (out.width < 1 || out.width > most || out.height < 1 || out.height > most) return std::nullopt;
    return out;
}

class PngReader : public PictureReader {
  public:
    PngReader(std::string_view bytes, const PlainPng& png) : bytes_(bytes) {
        layout_.width = layout_.full_width = static_cast<int>(png.width);
        layout_.height = layout_.full_height = static_cast<int>(png.height);
        layout_.depth = 1;
        layout_.channels = png.grey ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
        layout_.exposure = png.exposure;
        layout_.made_by = png.made_by;
        layout_.format = "png";
        layout_.colour_space = "sRGB";
    }

    [[nodiscard]] const PictureLayout& layout() const override { return layout_; }

    [[nodiscard]] std::string read(int channels, float* to) override {
        const std::size_t stored = layout_.channels.size(), wanted = static_cast<std::size_t>(channels);
        if (wanted > stored) return "more channels wanted than there are";
        const std::size_t pixels =
            static_cast<std::size_t>(layout_.width) * static_cast<std::size_t>(layout_.height);
        std::vector<std::uint8_t> values(pixels * stored);
        png_image png{};
        png.version = PNG_IMAGE_VERSION;
        bool ok = png_image_begin_read_from_memory(&png, bytes_.data(), bytes_.size()) != 0;
        if (ok) {
            png.format = stored == 1 ? PNG_FORMAT_GRAY : PNG_FORMAT_RGB;
            ok = png_image_finish_read(&png, nullptr, values.data(), 0, nullptr) != 0;
        }
        const std::string problem = ok ? "" : png.message;
        png_image_free(&png);
        if (!ok) return problem.empty() ? "no reason given" : problem;
        for (std::size_t i = 0; i < pixels; ++i) {
            for (std::size_t c = 0; c < wanted; ++c)
                to[i * wanted + c] = static_cast<float>(values[i * stored + c]) * (1.0F / 255);
        }
        return "";
    }

  private:
    std::string_view bytes_;
    PictureLayout layout_;
};

}  // namespace

std::unique_ptr<PictureReader> open_plain_png(std::string_view bytes) {
    const std::optional<PlainPng> png = plain_png(bytes);
    return png ? std::make_unique<PngReader>(bytes, *png) : nullptr;
}

}  // namespace postlens
