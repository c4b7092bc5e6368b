// Describes the parts of a sample file, a multi-part OpenEXR file: names, channels and data windows.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pictures/exr/exr_input.h"
#include "records/record_check.h"
#include "records/sample_file.h"

namespace postlens::layout {

/// Kinds of parts in the OpenEXR file: the pinhole image, the records (surface hits), and a summary of each
/// row of records. The file begins with one part of each kind, in this order.
enum Part : int { picture_part, records_part, scanlines_part, parts_of_first_instant };
inline constexpr std::array<const char*, parts_of_first_instant> part_types{"scanlineimage", "deepscanline",
                                                                            "scanlineimage"};
/// Returns the index of a part in the sample file. Part 0 is the pinhole image. For each recorded instant,
/// two parts follow: the records, and the summaries of their rows (`scanlines`). So instant 0 has the parts 1
/// and 2, instant 1 has 3 and 4, and so on.
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
/// Returns the name of a part of the sample file. At instant 0, it is "picture" for the pinhole image,
/// "records" for the records, or "scanlines" for the summaries of their rows. At a further recorded instant i
/// > 0, it is "records.k<i>" or "scanlines.k<i>".
[[nodiscard]] std::string part_name(const PartPlace& place);
/// Compression of the chunks of records.
[[nodiscard]] ChunkCompression codec_of(RecordCompression compression);
/// Largest size in bytes of a chunk that OpenEXR can store.
inline constexpr std::uint64_t largest_chunk_bytes = 0x7FFFFFFF;

/// Returns the channels of a part in file order. OpenEXR sorts channels by the bytes of their names.
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

/// Summary of one row of records (surface hits), which the sample file stores in its part `scanlines`.
/// `facts` contains the number of records, the range of their depths, and their checksum.
struct ScanlineRow {
    static constexpr std::size_t byte_count = 32;
    ScanlineFacts facts;
    /// Checksum of the row of the pinhole image that has the same y. It is 0 if the image has no such row,
    /// for example in the overscan.
    std::uint64_t picture_checksum = 0;

    [[nodiscard]] std::array<std::uint8_t, byte_count> bytes(int y) const;
    /// Reads the summary of row y of the records from its bytes in the file. Returns nothing if the summary
    /// is damaged, that is, if its checksum does not match.
    [[nodiscard]] static std::optional<ScanlineRow> from_bytes(ByteView bytes, int y);
};

/// Returns the checksum (XXH3, 64 bits, seed 0) of an uncompressed row of the pinhole image. `planes`
/// contains the floats of the row in the order of the file: the blue values of all pixels, then the green,
/// then the red.
[[nodiscard]] std::uint64_t picture_row_checksum(ByteView planes);

}  // namespace postlens::layout
