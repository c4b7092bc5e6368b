#include <cstring>
#include <vector>

#include "records/file/record_scanline.h"
#include "records/file/sample_file_layout.h"
#include "records/packed_picture.h"
#include "records/quadtree.h"
#include "records/sample_file.h"

namespace postlens {

std::uint64_t packed_bytes(const SampleHeader& header, RecordCompression compression, const RecordBand& band,
                           int y_begin, int y_end) {
    // Number of bytes that a row needs in the file, apart from its compressed records:
    // - 32: header of its chunk in the part `records`
    // - 12: header of its chunk in the part `scanlines`
    // - ScanlineRow::byte_count: the summary of the row in `scanlines`
    // - 8 for each of the two chunks: its position in the file's table of chunks
    constexpr std::uint64_t around_row = 32 + 12 + layout::ScanlineRow::byte_count + 2 * 8;
    const RecordChannels channels{header.has_w, header.has_layers, header.has_bend, header.has_marks};
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

std::uint64_t packed_picture_bytes(const SampleHeader& header, RecordCompression compression,
                                   const RecordBand& band, int y) {
    if (y < 0 || y >= header.height) return 0;
    const auto width = static_cast<std::size_t>(header.width);
    std::vector<float> rgb(3 * width);
    picture_row(band, y, 0, header.width, rgb);
    Bytes planes(rgb.size() * sizeof(float)), packed;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::size_t x = 0; x < width; ++x)
            std::memcpy(planes.data() + (channel * width + x) * sizeof(float), &rgb[3 * x + channel],
                        sizeof(float));
    }
    const bool zips = compression == RecordCompression::zips;
    return ChunkCodec()
        .compress(zips ? ChunkCompression::zip : layout::codec_of(compression), planes, packed)
        .size();
}

}  // namespace postlens
