// Writes and reads sample files by bands of rows. A sample file is an OpenEXR file with several parts.
// docs/sample_file.md defines the format.
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

/// Summary of one row of records (surface hits): their number, depths and checksum. The file stores the
/// summaries separately, so they can be read without reading the records.
struct ScanlineFacts {
    std::uint32_t records = 0;
    float nearest_z = std::numeric_limits<float>::infinity();  ///< finite z' only; infinity if none
    float farthest_z = 0;                                      ///< finite z' only; 0 if none
    std::uint64_t checksum = 0;
};

/// Writes a sample file, which stores the records (surface hits) of a traced frame and its pinhole image. The
/// records are passed in bands of rows, from top to bottom, to save memory. The recorded instants of a moving
/// scene follow one another; the pinhole image shows the first one, instant 0.
///
/// The colours must be radiance without exposure, because SampleFileReader applies the exposure of the
/// header. The file appears at `path` when finish() is called.
class SampleFileWriter {
  public:
    SampleFileWriter(const std::filesystem::path& path, const SampleHeader& header,
                     RecordCompression compression);
    ~SampleFileWriter();
    SampleFileWriter(const SampleFileWriter&) = delete;
    SampleFileWriter& operator=(const SampleFileWriter&) = delete;
    SampleFileWriter(SampleFileWriter&&) = delete;
    SampleFileWriter& operator=(SampleFileWriter&&) = delete;

    /// Writes the next rows of records. The rows of an instant must be passed from top to bottom, from y =
    /// -overscan to y = height + overscan. Each row extends from x = -overscan to x = width + overscan. The
    /// last row and column contain corners of the last pixels.
    void write(const RecordBand& band);
    /// Ends the current instant of a moving scene, so that the next rows belong to the next recorded instant,
    /// beginning with its top row. Throws Error(invalid_input) if rows of the current instant are missing, or
    /// if the header states no further instants.
    void next_instant();
    /// Completes the file and moves it from its temporary name to its path. Returns its size in bytes.
    std::uint64_t finish();
    /// Returns the pinhole image of the frame. The writer computes it from the records of instant 0, row by
    /// row. So the image is complete after all rows of this instant have been written.
    [[nodiscard]] const Image& picture() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Returns the number of bytes that the records in rows y_begin to y_end - 1 of `band` occupy in a sample
/// file. Includes the entries of these rows in the file's tables of offsets, but not the pinhole image.
[[nodiscard]] std::uint64_t packed_bytes(const SampleHeader& header, RecordCompression compression,
                                         const RecordBand& band, int y_begin, int y_end);

/// What a reader does if a file is damaged, but its header is not.
enum class Damage {
    refuse,  ///< reading a damaged or missing scanline throws an error
    salvage  ///< damaged scanlines are found on opening and replaced
};

/// Reads a sample file. Every function throws Error(invalid_input) if the file is damaged. With
/// Damage::salvage, a damaged row is replaced by samples of rays that hit nothing (stand_in_for_row).
class SampleFileReader {
  public:
    /// With Damage::salvage, at least one in 64 rows must be undamaged. Otherwise, a small damaged file could
    /// claim a huge image.
    static constexpr std::size_t least_whole_share = 64;

    /// Opens a sample file. Colours are multiplied by 2^exposure_stops; by default, the exposure is read from
    /// the file.
    explicit SampleFileReader(const std::filesystem::path& path, Damage damage = Damage::refuse,
                              std::optional<double> exposure_stops = std::nullopt);
    ~SampleFileReader();
    SampleFileReader(const SampleFileReader&) = delete;
    SampleFileReader& operator=(const SampleFileReader&) = delete;
    SampleFileReader(SampleFileReader&&) = delete;
    SampleFileReader& operator=(SampleFileReader&&) = delete;

    [[nodiscard]] const SampleHeader& header() const;
    /// Returns the exposure at which colours are read, in stops.
    [[nodiscard]] double exposure_stops() const;
    /// Number of instants at which a moving scene is recorded. The pinhole image in the file shows instant 0.
    [[nodiscard]] std::size_t instants() const;
    [[nodiscard]] double instant_s(std::size_t instant) const;
    /// Returns one summary per row of records (their number, depths and checksum), for the rows from y =
    /// -overscan to y = height + overscan. Negative rows lie above the image.
    [[nodiscard]] std::span<const ScanlineFacts> scanlines(std::size_t instant = 0) const;
    /// Returns the number of records at all instants.
    [[nodiscard]] std::uint64_t record_count() const;
    [[nodiscard]] std::uint64_t file_bytes() const;
    [[nodiscard]] RecordCompression compression() const;
    /// Range of the rows of records (surface hits). Records lie at the corners of pixels, so there is one
    /// more row of records than of pixels. The first row is y_begin() = -overscan, and the last row is
    /// y_end() - 1 = height + overscan.
    [[nodiscard]] int y_begin() const;
    [[nodiscard]] int y_end() const;
    /// Range of the columns of records: from x_begin() = -overscan to x_end() - 1 = width + overscan. Records
    /// lie at the corners of pixels, so there is one more column of records than of pixels.
    [[nodiscard]] int x_begin() const;
    [[nodiscard]] int x_end() const;

    /// Reads rows y_begin to y_end - 1 of an instant, and verifies their checksums and values. Rows can be
    /// read in any order. Reuses the memory of `band`.
    void read(int y_begin, int y_end, RecordBand& band, std::size_t instant = 0) const;
    /// Returns the damaged rows, ordered by instant and from top to bottom. If the file was opened with
    /// Damage::salvage, these rows have been replaced by samples of rays that hit nothing. Otherwise, the
    /// damage is not searched for, and the result is empty.
    [[nodiscard]] std::span<const LostRows> lost_rows() const;
    /// Returns the times of recorded instants that were removed because all their rows are damaged.
    [[nodiscard]] std::span<const double> lost_instants_s() const;
    /// Returns the pinhole image that is stored in the file. Throws if this image is damaged. This is so even
    /// with Damage::salvage, which repairs only damaged records. In this case, the caller can compute the
    /// image from the records.
    [[nodiscard]] Image picture() const;
    /// True if the file is an OpenEXR file with the version attribute that postlens writes.
    [[nodiscard]] static bool is_sample_file(const std::filesystem::path& path);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace postlens
