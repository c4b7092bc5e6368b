// The parts of a sample file: their names, channels and windows. Also the rows of the parts `scanlines`,
// which summarise the rows of records.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pictures/exr/exr_input.h"
#include "records/record_check.h"
#include "records/sample_file.h"

namespace postlens::layout {

/// Kind of a part. For the parts of the frame's own instant, the value is the part's index in the file.
enum Part : int { picture_part, records_part, scanlines_part, parts_of_first_instant };
inline constexpr std::array<const char*, parts_of_first_instant> part_types{"scanlineimage", "deepscanline",
                                                                            "scanlineimage"};
/// Index in the file of a part of `instant`. The picture comes first; records and scanlines of each instant
/// follow.
[[nodiscard]] inline int part_index(Part part, std::size_t instant) {
    return static_cast<int>(part) + (part == picture_part ? 0 : 2 * static_cast<int>(instant));
}
[[nodiscard]] inline std::size_t parts_of(std::size_t keys) {
    return parts_of_first_instant + 2 * keys;
}
/// Kind and instant of a part.
struct PartPlace {
    Part part;
    std::size_t instant;
};
[[nodiscard]] inline PartPlace part_at(std::size_t index) {
    if (index == 0) return {picture_part, 0};
    return {index % 2 == 1 ? records_part : scanlines_part, (index - 1) / 2};
}
/// Name of a part: "picture", "records" or "scanlines"; for key i, counted from 1, "records.k<i>" or
/// "scanlines.k<i>".
[[nodiscard]] std::string part_name(const PartPlace& place);
/// Compression of the chunks of records.
[[nodiscard]] ChunkCompression codec_of(RecordCompression compression);
/// Largest size of a chunk that OpenEXR can store, bytes.
inline constexpr std::uint64_t largest_chunk_bytes = 0x7FFFFFFF;

/// Channels of a part in file order, which is the byte order of their names.
[[nodiscard]] std::vector<ExrChannel> channels_of(Part part, RecordChannels channels);

[[nodiscard]] Window display_window(const SampleHeader& header);
[[nodiscard]] Window data_window(Part part, const SampleHeader& header);
[[nodiscard]] inline int rows_of(const Window& window) {
    return window.y_max - window.y_min + 1;
}
[[nodiscard]] inline int columns_of(const Window& window) {
    return window.x_max - window.x_min + 1;
}
[[nodiscard]] inline std::size_t chunks_of(int rows, ChunkCompression compression) {
    const int step = rows_per_chunk(compression);
    return static_cast<std::size_t>((rows + step - 1) / step);
}

/// A row of part `scanlines`. The row summarises one scanline of records and contains the checksum of the
/// pinhole image's row (0 outside the raster). Its own bytes end with a checksum over y and all other fields.
struct ScanlineRow {
    static constexpr std::size_t byte_count = 32;
    ScanlineFacts facts;
    std::uint64_t picture_checksum = 0;

    [[nodiscard]] std::array<std::uint8_t, byte_count> bytes(int y) const;
    /// Reads the bytes of row y. Empty if their checksum does not match.
    [[nodiscard]] static std::optional<ScanlineRow> from_bytes(ByteView bytes, int y);
};

/// XXH3 (64 bit, seed 0) of a row of part `picture` before compression: all B, then all G, then all R, as
/// floats.
[[nodiscard]] std::uint64_t picture_row_checksum(ByteView planes);

}  // namespace postlens::layout
