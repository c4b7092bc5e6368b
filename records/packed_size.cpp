#include "records/record_scanline.h"
#include "records/sample_file.h"
#include "records/sample_file_layout.h"

namespace postlens {

std::uint64_t packed_bytes(const SampleHeader& header, RecordCompression compression, const RecordBand& band,
                           int y_begin, int y_end) {
    // Of each row: what stands before its chunk and its row of part scanlines, and their places in the
    // tables.
    constexpr std::uint64_t around_row = 32 + 12 + layout::ScanlineRow::byte_count + 2 * 8;
    const RecordChannels channels{header.has_w, header.has_layers, header.has_bend};
    ScanlineBytes bytes(band.width(), channels);
    ChunkCodec codec;
    Bytes packed;
    std::uint64_t total = 0;
    for (int y = y_begin; y < y_end; ++y) {
        bytes.pack(y, band.x_begin,
                   std::span(band.offsets)
                       .subspan(band.pixel(band.x_begin, y), static_cast<std::size_t>(band.width()) + 1),
                   band.records);
        total += around_row + codec.compress(layout::codec_of(compression), bytes.counts(), packed).size();
        total += codec.compress(layout::codec_of(compression), bytes.channel_data(), packed).size();
    }
    return total;
}

}  // namespace postlens
