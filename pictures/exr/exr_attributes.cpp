#include "pictures/exr/exr_attributes.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "core/error.h"
#include "pictures/exr/exr_input.h"

namespace postlens {
namespace {

constexpr std::array<std::pair<std::string_view, std::size_t>, 24> fixed_sizes{{
    {"box2f", 16},
    {"box2i", 16},
    {"chromaticities", 32},
    {"compression", 1},
    {"deepImageState", 1},
    {"double", 8},
    {"envmap", 1},
    {"float", 4},
    {"int", 4},
    {"keycode", 28},
    {"lineOrder", 1},
    {"m33d", 72},
    {"m33f", 36},
    {"m44d", 128},
    {"m44f", 64},
    {"rational", 8},
    {"tiledesc", 9},
    {"timecode", 8},
    {"v2d", 16},
    {"v2f", 8},
    {"v2i", 8},
    {"v3d", 24},
    {"v3f", 12},
    {"v3i", 12},
}};

/// `value` contains the bytes of an OpenEXR attribute, which begins with a list of channels. Returns the
/// offset of the first byte after this list, or 0 if the list has no end because the file is damaged.
std::size_t end_of_channels(ByteView value) {
    std::size_t at = 0;
    for (;;) {
        const auto name_end =
            std::find(value.begin() + static_cast<std::ptrdiff_t>(at), value.end(), std::uint8_t{0});
        if (name_end == value.end()) return 0;
        const auto name = static_cast<std::size_t>(name_end - value.begin());
        if (name == at) return name + 1;
        constexpr std::size_t type_and_sampling = 16;
        at = name + 1 + type_and_sampling;
        if (at >= value.size()) return 0;
    }
}

bool strings_fill(ByteView value) {
    std::uint64_t at = 0;
    while (at < value.size()) {
        std::uint32_t length = 0;
        if (value.size() - at < sizeof(length)) return false;
        std::memcpy(&length, value.data() + at, sizeof(length));
        at += sizeof(length) + std::uint64_t{length};
    }
    return at == value.size();
}

bool preview_fills(ByteView value) {
    std::array<std::uint32_t, 2> edges{};
    if (value.size() < sizeof(edges)) return false;
    std::memcpy(edges.data(), value.data(), sizeof(edges));
    // This limit prevents the product below from overflowing.
    if (std::max(edges[0], edges[1]) > std::numeric_limits<std::int32_t>::max() / 4) return false;
    return value.size() == sizeof(edges) + 4 * std::uint64_t{edges[0]} * edges[1];
}

/// Returns an upper bound of the memory, in bytes, that the OpenEXR library allocates for one chunk (a tile,
/// or rows that are compressed together). It needs 4 bytes per channel and pixel. If `tiled` is false, a tile
/// size in the part's header is ignored.
std::uint64_t chunk_bytes(const ExrPart& part, bool tiled) {
    const auto window = part.get_window("dataWindow");
    const auto channels = part.raw("channels", "chlist");
    const auto compression = part.raw("compression", "compression");
    if (!channels) return 0;
    constexpr std::size_t after_name = 16;
    std::uint64_t pixel = 0;
    for (std::size_t at = 0; at < channels->size() && (*channels)[at] != 0; pixel += 4) {
        while (at < channels->size() && (*channels)[at] != 0) ++at;
        at += 1 + after_name;
    }
    // Both factors are limited so that their product cannot overflow.
    pixel = std::min<std::uint64_t>(pixel, 1U << 20U);
    constexpr std::uint32_t widest_tile = 1U << 20U;
    constexpr std::array<std::uint64_t, 10> rows{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
    // The OpenEXR library assumes ZIP compression if the file does not state one.
    constexpr std::size_t zip = 3;
    const std::size_t packed = compression && !compression->empty() ? (*compression)[0] : zip;
    std::array<std::uint32_t, 2> tile{};
    const auto tiles = part.raw("tiles", "tiledesc");
    if (tiled && tiles && tiles->size() > sizeof(tile)) {
        std::memcpy(tile.data(), tiles->data(), sizeof(tile));
        return pixel * std::min(tile[0], widest_tile) * std::min(tile[1], widest_tile);
    }
    // If the header states no data window (the rectangle of stored pixels), the OpenEXR library assumes a
    // small image. Its chunks need hardly any memory, so the bound is 0.
    if (!window) return 0;
    const std::int64_t width = std::int64_t{window->x_max} - window->x_min + 1;
    return width > 0 ? pixel * static_cast<std::uint64_t>(width) * rows[std::min(packed, rows.size() - 1)]
                     : 0;
}

}  // namespace

bool fills_its_size(std::string_view type, ByteView value) {
    for (const auto& [name, size] : fixed_sizes) {
        if (type == name) return value.size() == size;
    }
    if (type == "chlist") return !value.empty() && end_of_channels(value) == value.size();
    if (type == "stringvector") return strings_fill(value);
    if (type == "preview") return preview_fills(value);
    if (type == "floatvector") return value.size() % sizeof(float) == 0;
    if (type == "idmanifest") return value.size() >= 4;
    return true;
}

void check_exr_headers(const std::filesystem::path& path) {
    const InputFile file(path);
    constexpr std::array<std::uint8_t, 5> openexr_2{0x76, 0x2f, 0x31, 0x01, 2};
    std::array<std::uint8_t, openexr_2.size()> begin{};
    if (file.size() < begin.size()) return;
    file.read_at(0, begin);
    if (begin != openexr_2) return;
    const ExrHeaders headers =
        read_exr_headers(file, std::numeric_limits<std::size_t>::max(), AttributeSizes::filled);
    for (const ExrPart& part : headers.parts) {
        const std::string type = part.get_string("type").value_or("");
        const bool tiled = headers.multi_part ? type.find("tile") != std::string::npos : headers.tiled;
        const std::uint64_t bytes = chunk_bytes(part, tiled);
        if (bytes > largest_chunk_bytes) {
            fail(ExitCode::invalid_input, "{}: too wide (got {} bytes a chunk of rows; expected {} or less)",
                 file.name(), bytes, largest_chunk_bytes);
        }
    }
}

}  // namespace postlens
