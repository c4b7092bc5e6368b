// One scanline of records as bytes: the contents of a deep OpenEXR chunk, and the input of its checksum.
#pragma once

#include <cstdint>
#include <span>

#include "pictures/exr/chunk_codec.h"
#include "records/record.h"
#include "records/record_check.h"

namespace postlens {

/// Bytes per record before compression: 28, plus 16 for W, 2 for W.bend, 2 for the mark and 4 for the layer,
/// if the file has these channels.
[[nodiscard]] std::size_t bytes_per_record(RecordChannels channels);

/// A scanline before compression, little-endian. First y as int32; then per pixel, as uint32, the number of
/// records up to and including this pixel; then the channels in the order of their names (B G R W.bend W.xx
/// W.xy W.yx W.yy Z id layer mark node.path sample.x sample.y). A channel has the values of all records,
/// pixel by pixel.
class ScanlineBytes {
  public:
    ScanlineBytes(int width, RecordChannels channels) : width_(width), channels_(channels) {}

    /// Reserves memory for `records` records of scanline y.
    void prepare(int y, std::uint32_t records);
    /// Packs the records of scanline y. Pixel x_begin + i has the records [offsets[i], offsets[i + 1]) of
    /// `records`; their positions must lie in this pixel.
    void pack(int y, int x_begin, std::span<const std::uint32_t> offsets, std::span<const Record> records);

    /// Computes the index of each pixel's first record from the table of counts. `offsets` has width + 1
    /// entries, the first of which becomes 0. Returns false if the counts decrease, or if the last is not the
    /// number of records given to `prepare`.
    [[nodiscard]] bool unpack_offsets(std::span<std::uint32_t> offsets) const;
    /// Unpacks the records in file order, using the offsets from `unpack_offsets`. W and layer get default
    /// values if the file has no such channel. Returns false if a position is not a multiple of 1/1024 px in
    /// [0, 1).
    [[nodiscard]] bool unpack_records(int x_begin, std::span<const std::uint32_t> offsets,
                                      std::span<Record> records) const;

    /// XXH3 (64 bit, seed 0) of all bytes.
    [[nodiscard]] std::uint64_t checksum() const;

    [[nodiscard]] std::span<std::uint8_t> counts() {
        return std::span(bytes_).subspan(y_bytes, count_bytes());
    }
    [[nodiscard]] std::span<std::uint8_t> channel_data() {
        return std::span(bytes_).subspan(y_bytes + count_bytes());
    }

  private:
    static constexpr std::size_t y_bytes = 4;
    [[nodiscard]] std::size_t count_bytes() const { return static_cast<std::size_t>(width_) * 4; }

    int width_;
    RecordChannels channels_;
    int y_ = 0;
    std::uint32_t records_ = 0;
    Bytes bytes_;
};

}  // namespace postlens
