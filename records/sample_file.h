// The sample file: OpenEXR, multi-part, written and read in bands of rows. Format: docs/sample_file.md.
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

/// Summary of one scanline of records, stored in the file so that the records need not be read for it.
struct ScanlineFacts {
    std::uint32_t records = 0;
    float nearest_z = std::numeric_limits<float>::infinity();  ///< finite z' only; infinity if none
    float farthest_z = 0;                                      ///< finite z' only; 0 if none
    std::uint64_t checksum = 0;
};

/// Writes a sample file in bounded memory. Colours of records are radiance, whatever exposure the header
/// names. Bands are written from top to bottom, first those of the frame's own instant, then those of each
/// key. The file appears at `path` only when `finish()` is called.
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
    /// [-overscan, width + overscan + 1). Also computes the pinhole image (part 0), from the records of the
    /// frame's own instant.
    void write(const RecordBand& band);
    /// Starts the next instant of the header's `key_times_s`, at the top row. Throws Error(invalid_input) if
    /// the present instant lacks rows or no key is left.
    void next_instant();
    /// Completes the file and moves it to its path. Returns its size in bytes.
    std::uint64_t finish();
    /// The pinhole image of part 0; complete after the last band.
    [[nodiscard]] const Image& picture() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Size in the file of the rows [y_begin, y_end) of a band, including their tables but not the pinhole image,
/// bytes.
[[nodiscard]] std::uint64_t packed_bytes(const SampleHeader& header, RecordCompression compression,
                                         const RecordBand& band, int y_begin, int y_end);

/// How a reader treats damage behind the header.
enum class Damage {
    refuse,  ///< reading a damaged or missing scanline is an error
    salvage  ///< damaged scanlines are found when the file is opened, and left out
};

/// Reads a sample file. Every function throws Error(invalid_input), naming the file, if the file is damaged
/// or incomplete. Counts and windows are checked before memory is allocated.
///
/// With Damage::salvage all records are read and checked when the file is opened. A damaged or missing row is
/// replaced by one in which rays hit nothing (stand_in_for_row); a key without any undamaged row is removed
/// from the instants. A damaged header is still an error, and so is a file with fewer than one undamaged row
/// in `least_whole_share` at its own instant. An undamaged file reads the same with both settings.
class SampleFileReader {
  public:
    /// If fewer than one row in this number is undamaged, the file is not read. The limit bounds the size of
    /// the image that a small damaged file can claim to have.
    static constexpr std::size_t least_whole_share = 64;

    /// Colours are read as radiance times 2^exposure_stops. Absent: the header's exposure, so that 1 is
    /// white.
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
    /// Number of recorded instants: the frame's own, number 0, and the keys.
    [[nodiscard]] std::size_t instants() const;
    [[nodiscard]] double instant_s(std::size_t instant) const;
    /// One entry per scanline of records; the first is y = -overscan.
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

    /// Reads rows [y_begin, y_end) of an instant, in canonical order and from anywhere in the file. Verifies
    /// checksums, paths, positions and finiteness. Reuses the memory of `band`.
    void read(int y_begin, int y_end, RecordBand& band, std::size_t instant = 0) const;
    /// Rows that were left out, by instant, from top to bottom; empty without Damage::salvage.
    [[nodiscard]] std::span<const LostRows> lost_rows() const;
    /// Times of the keys without any undamaged row.
    [[nodiscard]] std::span<const double> lost_instants_s() const;
    /// The pinhole image stored as part 0. Damage to it is an error even with Damage::salvage; it can be
    /// computed from the records instead.
    [[nodiscard]] Image picture() const;
    /// True if the file is an OpenEXR file with the version attribute of postlens.
    [[nodiscard]] static bool is_sample_file(const std::filesystem::path& path);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace postlens
