// The sample file: a multi-part OpenEXR file, written and read in bands of rows. docs/sample_file.md defines
// the format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pictures/image.h"
#include "records/lost_rows.h"
#include "records/record.h"
#include "records/sample_header.h"

namespace postlens {

enum class RecordCompression { none, rle, zips };

/// Summary of one scanline of records. The file stores it, so that it can be used without reading the
/// records.
struct ScanlineFacts {
    std::uint32_t records = 0;
    float nearest_z = std::numeric_limits<float>::infinity();  ///< finite z' only; infinity if none
    float farthest_z = 0;                                      ///< finite z' only; 0 if none
    std::uint64_t checksum = 0;
};

/// Writes a sample file with a bounded amount of memory. Colours of records are radiance, whatever exposure
/// the header states. Bands are written from top to bottom: first those of the frame's own instant, then
/// those of each key (further recorded instant). The file appears at `path` only when `finish()` is called.
class SampleFileWriter {
  public:
    SampleFileWriter(const std::filesystem::path& path, const SampleHeader& header,
                     RecordCompression compression);
    ~SampleFileWriter();
    SampleFileWriter(const SampleFileWriter&) = delete;
    SampleFileWriter& operator=(const SampleFileWriter&) = delete;
    SampleFileWriter(SampleFileWriter&&) = delete;
    SampleFileWriter& operator=(SampleFileWriter&&) = delete;

    /// Writes the next rows of records. Rows range over [-overscan, height + overscan + 1), columns over
    /// [-overscan, width + overscan + 1). From the records of the frame's own instant, the pinhole image
    /// (part 0) is computed as well.
    void write(const RecordBand& band);
    /// Starts the next instant of the header's `key_times_s`, at the top row. Throws Error(invalid_input) if
    /// rows of the current instant are missing, or if there are no further keys.
    void next_instant();
    /// Completes the file and moves it to its path. Returns the file's size in bytes.
    std::uint64_t finish();
    /// The pinhole image of part 0; complete after the last band.
    [[nodiscard]] const Image& picture() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Size, bytes, that the rows [y_begin, y_end) of a band take in the file. Includes the rows' entries in
/// offset tables, but not the pinhole image.
[[nodiscard]] std::uint64_t packed_bytes(const SampleHeader& header, RecordCompression compression,
                                         const RecordBand& band, int y_begin, int y_end);

/// What a reader does about damage in the part of the file behind the header.
enum class Damage {
    refuse,  ///< reading a damaged or missing scanline throws an error
    salvage  ///< damaged scanlines are found on opening and replaced
};

/// Reads a sample file. Every function throws Error(invalid_input), which names the file, if the file is
/// damaged or incomplete. Counts and windows are checked before memory is allocated.
///
/// With Damage::salvage, all records are read and checked when the file is opened. A damaged or missing row
/// is replaced by samples whose rays hit nothing (stand_in_for_row). A key (further recorded instant) without
/// any undamaged row is removed. Two kinds of damage are still errors: a damaged header, and fewer than one
/// undamaged row in `least_whole_share` at the frame's own instant. An undamaged file gives the same records
/// with both settings.
class SampleFileReader {
  public:
    /// The file is rejected if fewer than one row in this number is undamaged. The limit bounds the image
    /// size that a small damaged file can claim.
    static constexpr std::size_t least_whole_share = 64;

    /// Colours are read as radiance times 2^exposure_stops. If absent, the exposure in the header is used,
    /// with which the value 1 is white.
    explicit SampleFileReader(const std::filesystem::path& path, Damage damage = Damage::refuse,
                              std::optional<double> exposure_stops = std::nullopt);
    ~SampleFileReader();
    SampleFileReader(const SampleFileReader&) = delete;
    SampleFileReader& operator=(const SampleFileReader&) = delete;
    SampleFileReader(SampleFileReader&&) = delete;
    SampleFileReader& operator=(SampleFileReader&&) = delete;

    [[nodiscard]] const SampleHeader& header() const;
    /// The exposure at which colours are read.
    [[nodiscard]] double exposure_stops() const;
    /// Number of recorded instants. Instant 0 is the frame's own; the others are the keys.
    [[nodiscard]] std::size_t instants() const;
    [[nodiscard]] double instant_s(std::size_t instant) const;
    /// One entry per scanline of records, from y = -overscan on.
    [[nodiscard]] std::span<const ScanlineFacts> scanlines(std::size_t instant = 0) const;
    /// Number of records of all instants.
    [[nodiscard]] std::uint64_t record_count() const;
    [[nodiscard]] std::uint64_t file_bytes() const;
    [[nodiscard]] RecordCompression compression() const;
    /// Rows of records: [-overscan, height + overscan + 1).
    [[nodiscard]] int y_begin() const;
    [[nodiscard]] int y_end() const;
    /// Columns of records: [-overscan, width + overscan + 1).
    [[nodiscard]] int x_begin() const;
    [[nodiscard]] int x_end() const;

    /// Reads rows [y_begin, y_end) of an instant, from anywhere in the file, in canonical order. Verifies
    /// checksums, paths and positions, and that all values are finite. Reuses the memory of `band`.
    void read(int y_begin, int y_end, RecordBand& band, std::size_t instant = 0) const;
    /// Damaged rows that were replaced, by instant, from top to bottom. Empty without Damage::salvage.
    [[nodiscard]] std::span<const LostRows> lost_rows() const;
    /// Times of the removed keys, which have no undamaged row.
    [[nodiscard]] std::span<const double> lost_instants_s() const;
    /// The pinhole image, stored as part 0. If part 0 is damaged, this throws even with Damage::salvage; the
    /// image can be computed from the records instead.
    [[nodiscard]] Image picture() const;
    /// True if the file is an OpenEXR file that has the version attribute of postlens.
    [[nodiscard]] static bool is_sample_file(const std::filesystem::path& path);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace postlens
