// Flat OpenEXR files, one part of scanlines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "records/chunk_codec.h"
#include "records/exr_input.h"

namespace postlens {

struct FlatExr {
    /// Pixel (0, 0) is at `first`, its neighbours `pixel_bytes` and `row_bytes` on.
    struct Channel {
        std::string name;
        ExrChannel::Type type = ExrChannel::Type::float32;
        const void* first = nullptr;
        bool one_row = false;  ///< every row is the one at `first`, whose values lie side by side
    };
    Window display, data;
    std::vector<Channel> channels;
    std::size_t pixel_bytes = 0, row_bytes = 0;
    ChunkCompression compression = ChunkCompression::rle;
    std::vector<std::pair<std::string, std::string>> texts;  ///< attributes
};

/// Writes `path`, an existing file, from its beginning on. `shown_name` stands in messages. Returns XXH3 of
/// the file where that is not compressed. Throws Error(cannot_write), on a full disk too.
std::optional<std::uint64_t> write_flat_exr(const std::filesystem::path& path, const std::string& shown_name,
                                            const FlatExr& picture);

}  // namespace postlens
