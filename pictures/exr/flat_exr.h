// Writes flat OpenEXR files that have one part, stored in scanlines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pictures/exr/chunk_codec.h"
#include "pictures/exr/exr_input.h"

namespace postlens {

struct FlatExr {
    /// An image channel. `first` points to its value at pixel (0, 0). `pixel_bytes` and `row_bytes` are the
    /// distances to the next pixel and row.
    struct Channel {
        std::string name;
        ExrChannel::Type type = ExrChannel::Type::float32;
        const void* first = nullptr;
        enum class Layout {
            pixels,   ///< values are next to the other channels of the same pixel
            plane,    ///< all values of the channel are adjacent, row after row
            one_row,  ///< all rows of the image are equal to the row at `first`
        };
        Layout layout = Layout::pixels;
    };
    Window display, data;
    std::vector<Channel> channels;
    std::size_t pixel_bytes = 0, row_bytes = 0;
    ChunkCompression compression = ChunkCompression::rle;
    std::vector<std::pair<std::string, std::string>> texts;  ///< string attributes: names and values
};

/// Overwrites the file `path`. Returns the XXH3 hash of the file if it is uncompressed, and empty otherwise.
/// `shown_name` is the file name in error messages. Throws Error(cannot_write), for example if the disk is
/// full.
std::optional<std::uint64_t> write_flat_exr(const std::filesystem::path& path, const std::string& shown_name,
                                            const FlatExr& picture);

}  // namespace postlens
