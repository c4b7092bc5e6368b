// Converts one scanline of records (surface hits) to the bytes of a chunk of the deep OpenEXR file, and back.
// Computes the checksum of these bytes.
#pragma once

#include <cstdint>
#include <span>

#include "pictures/exr/chunk_codec.h"
#include "records/record.h"
#include "records/record_check.h"

namespace postlens {

/// Returns the number of bytes per record before compression. It depends on the optional channels of the
/// file.
[[nodiscard]] std::size_t bytes_per_record(RecordChannels channels);

/// One row of records (surface hits), as the bytes that the file stores, before compression. The bytes are in
/// little-endian order:
/// - y as int32
/// - for each pixel, the number of records up to and including that pixel, as uint32
/// - the channels B G R W.bend W.xx W.xy W.yx W.yy Z id layer mark node.path sample.x sample.y, which contain
///   the fields of Record (docs/sample_file.md); each channel has one value per record, pixel by pixel
class ScanlineBytes {
  public:
    ScanlineBytes(int width, RecordChannels channels) : width_(width), channels_(channels) {}

    /// Reserves memory for `records` records of scanline y.
    void prepare(int y, std::uint32_t records);
    /// Converts the records of scanline y to the bytes of the file. `records` contains the records of all
    /// pixels of the row. Those of pixel x_begin + i have the indices offsets[i] to offsets[i + 1] - 1.
    void pack(int y, int x_begin, std::span<const std::uint32_t> offsets, std::span<const Record> records);

    /// Computes where the records of each pixel begin. offsets[i] becomes the index of the first record of
    /// the i-th pixel, and the last element becomes the total number of records. Returns false if the stored
    /// numbers of records are damaged, i.e. contradict each other.
    [[nodiscard]] bool unpack_offsets(std::span<std::uint32_t> offsets) const;
    /// Unpacks the records of the row. Fields without a channel in the file become 0, except Record::w, which
    /// becomes the unit matrix divided by the depth. This is its value for all surfaces seen directly.
    /// Returns false if a position is damaged.
    [[nodiscard]] bool unpack_records(int x_begin, std::span<const std::uint32_t> offsets,
                                      std::span<Record> records) const;

    /// Returns the checksum (XXH3, 64 bits, seed 0) of all bytes.
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
