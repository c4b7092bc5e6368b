#include "pictures/encoded_picture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <png.h>

#include "core/error.h"
#include "core/threads.h"
#include "pictures/formats/picture_library.h"
#include "pictures/srgb.h"

namespace postlens {
namespace {

std::uint8_t byte_by_power(float v) {
    return static_cast<std::uint8_t>(std::lround(srgb_from_linear(v) * 255.0F));
}

/// Table that converts linear values to sRGB bytes faster than the power function. Its cells divide the
/// floats from `least` to 1 into ranges of consecutive bit patterns, so narrow that the byte changes at most
/// once within a cell.
struct ByteTable {
    static constexpr int octaves = 13, cell_shift = 15, cells = octaves << (23 - cell_shift);
    static constexpr float least = 1.0F / (1 << octaves);  ///< smaller values are black
    static constexpr std::uint32_t first = std::bit_cast<std::uint32_t>(least);
    /// In cell i of the table, a float whose bits, read as an integer, are less than next[i] is converted to
    /// byte[i]. Any other float of this cell is converted to byte[i] + 1.
    std::array<std::uint32_t, cells> next{};
    std::array<std::uint8_t, cells> byte{};

    ByteTable() {
        const auto at = [](std::uint32_t bits) { return byte_by_power(std::bit_cast<float>(bits)); };
        for (std::uint32_t i = 0; i < cells; ++i) {
            std::uint32_t low = first + (i << cell_shift), high = low + (1U << cell_shift);
            byte[i] = at(low);
            if (at(high - 1) == byte[i]) {
                next[i] = high;
                continue;
            }
            while (high - low > 1) {
                const std::uint32_t middle = low + (high - low) / 2;
                (at(middle) == byte[i] ? low : high) = middle;
            }
            next[i] = high;
        }
    }
};

const ByteTable& byte_table() {
    static const ByteTable table;
    return table;
}

std::uint8_t byte_of(const ByteTable& table, float v) {
    if (!(v >= ByteTable::least)) return 0;
    if (v >= 1) return 255;
    const auto bits = std::bit_cast<std::uint32_t>(v);
    const std::uint32_t cell = (bits - ByteTable::first) >> ByteTable::cell_shift;
    return static_cast<std::uint8_t>(table.byte[cell] + (bits >= table.next[cell] ? 1 : 0));
}

struct PngOutput {
    std::string bytes, problem;  ///< both have reserved memory, which they never exceed
};

/// Returns an upper bound of the size of the PNG file, in bytes. Deflate slightly enlarges incompressible
/// data.
std::size_t most_bytes(const EncodedPicture& picture) {
    const std::size_t raw = picture.rgb.size() + static_cast<std::size_t>(picture.height);
    return raw + raw / 64 + 4096;
}

void append(png_structp png, png_bytep data, std::size_t size) {
    auto& out = *static_cast<PngOutput*>(png_get_io_ptr(png));
    // libpng is C code, through which no C++ exception may propagate. So png_error reports the error.
    if (out.bytes.capacity() - out.bytes.size() < size) png_error(png, "larger than its pixels");
    out.bytes.append(reinterpret_cast<const char*>(data), size);
}

[[noreturn]] void note_problem(png_structp png, png_const_charp text) {
    std::string& problem = static_cast<PngOutput*>(png_get_error_ptr(png))->problem;
    problem.assign(text, std::min(std::strlen(text), problem.capacity()));
    png_longjmp(png, 1);
}

void keep_quiet(png_structp /*png*/, png_const_charp /*warning*/) {}

/// libpng reports errors by longjmp, which runs no destructors. So this function must not contain objects
/// with destructors.
bool write_rows(png_structp png, png_infop info, const EncodedPicture& picture,
                std::vector<png_text>& texts) {
    // NOLINTNEXTLINE(cert-err52-cpp): how libpng reports errors
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_IHDR(png, info, static_cast<png_uint_32>(picture.width), static_cast<png_uint_32>(picture.height),
                 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    // Settings for fast compression. For rendered images, the PNG filter "Sub", used for every row,
    // compresses as well as choosing the best filter for each row, and takes less time. The compression level
    // 3 takes a third of the time of the default level.
    constexpr int quick = 3;
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_compression_level(png, quick);
    if (!texts.empty()) png_set_text(png, info, texts.data(), static_cast<int>(texts.size()));
    png_write_info(png, info);
    for (int y = 0; y < picture.height; ++y) png_write_row(png, picture.row(y));
    png_write_end(png, info);
    return true;
}

}  // namespace

std::uint8_t srgb_byte(float v) {
    return byte_of(byte_table(), v);
}

EncodedPicture encoded_8bit(const Image& image) {
    EncodedPicture out(image.width, image.height);
    out.exposure_stops = image.exposure_stops;
    out.made_by = image.made_by;
    const ByteTable& table = byte_table();
    const std::size_t row_values = static_cast<std::size_t>(image.width) * 3;
    parallel_for(static_cast<std::size_t>(image.height), [&](std::size_t y) {
        const float* from = image.rgb.data() + y * row_values;
        std::transform(from, from + row_values, out.rgb.data() + y * row_values,
                       [&table](float v) { return byte_of(table, v); });
    });
    return out;
}

std::string png_file(const EncodedPicture& picture, const std::string& shown_name) {
    constexpr std::size_t longest_problem = 200;
    PngOutput out;
    out.problem.reserve(longest_problem);
    out.bytes.reserve(most_bytes(picture));
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &out, note_problem, keep_quiet);
    png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
    bool ok = false;
    if (info != nullptr) {
        png_set_write_fn(png, &out, append, nullptr);
        // libpng requires non-const pointers, so the texts are copied.
        std::string keys[] = {exposure_attribute, made_by_attribute};
        std::string values[] = {picture.exposure_stops ? fmt::format("{}", *picture.exposure_stops) : "",
                                picture.made_by};
        std::vector<png_text> texts;
        for (std::size_t i = 0; i < std::size(keys); ++i) {
            if (values[i].empty()) continue;
            png_text& text = texts.emplace_back();
            text.compression = PNG_TEXT_COMPRESSION_NONE;
            text.key = keys[i].data();
            text.text = values[i].data();
            text.text_length = values[i].size();
        }
        ok = write_rows(png, info, picture, texts);
    } else {
        out.problem = "out of memory";
    }
    png_destroy_write_struct(&png, &info);
    if (!ok) fail(ExitCode::cannot_write, "{}: cannot write ({})", shown_name, out.problem);
    return std::move(out.bytes);
}

}  // namespace postlens
