// One scanline of records as bytes: the layout of a deep chunk, which is also what its checksum is taken of.
#pragma once

#include <cstdint>
#include <span>

#include "records/chunk_codec.h"
#include "records/record.h"
#include "records/record_check.h"

namespace postlens {

/// Bytes that a record takes before compression: 28, W 16 more, W.bend and mark 2 more each, layer 4 more.
[[nodiscard]] std::size_t bytes_per_record(RecordChannels channels);

/// A scanline before compression, little-endian: int32 y; per pixel the uint32 sum of the counts of the
/// pixels up to and with it; then each channel in the order of their names (B G R W.bend W.xx W.xy W.yx W.yy
/// Z id layer mark node.path sample.x sample.y), each with the values of all records, pixel by pixel.
class ScanlineBytes {
  public:
    ScanlineBytes(int width, RecordChannels channels) : width_(width), channels_(channels) {}

    /// Lays out room for `records` records of scanline y.
    void prepare(int y, std::uint32_t records);
    /// Fills it from the records of scanline y: pixel i of the row has the records [offsets[i], offsets[i +
    /// 1]) of `records`; their positions lie in the pixels x_begin + i of row y.
    void pack(int y, int x_begin, std::span<const std::uint32_t> offsets, std::span<const Record> records);

    /// Where pixel i's records begin, from the table of counts: width + 1 entries, first 0. False where the
    /// counts fall or do not add up to the records that `prepare` was told of.
    [[nodiscard]] bool unpack_offsets(std::span<std::uint32_t> offsets) const;
    /// The records in file order; W and layer get the values that absent channels stand for. Needs the
    /// offsets of `unpack_offsets`. False where a position is not a multiple of 1/1024 in [0, 1).
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
