// The sample file: OpenEXR, multi-part, written and read in bands of rows. Format: docs/sample_file.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "records/image.h"
#include "records/lost_rows.h"
#include "records/record.h"
#include "records/sample_header.h"

namespace postlens {

enum class RecordCompression { none, rle, zips };

/// What one scanline of records holds, kept apart from the records so that it costs nothing to ask.
struct ScanlineFacts {
    std::uint32_t records = 0;
    float nearest_z = std::numeric_limits<float>::infinity();  ///< finite z' only; infinity if none
    float farthest_z = 0;                                      ///< finite z' only; 0 if none
    std::uint64_t checksum = 0;
};

/// Writes records whose colours are radiance, whatever the header's exposure. Bands come in order, top to
/// bottom, first those of the frame's own instant, then those of each key, in bounded memory. Nothing appears
/// at `path` before `finish()`.
class SampleFileWriter {
  public:
    SampleFileWriter(const std::filesystem::path& path, const SampleHeader& header,
                     RecordCompression compression);
    ~SampleFileWriter();
    SampleFileWriter(const SampleFileWriter&) = delete;
    SampleFileWriter& operator=(const SampleFileWriter&) = delete;
    SampleFileWriter(SampleFileWriter&&) = delete;
    SampleFileWriter& operator=(SampleFileWriter&&) = delete;

    /// The next rows of records: the first band begins at -overscan, the last ends at height + overscan + 1,
    /// columns always [-overscan, width + overscan + 1). The pinhole picture (part 0) is computed here, from
    /// those of the frame's own instant.
    void write(const RecordBand& band);
    /// Goes on to the next of the header's `key_times_s`, once an instant is complete; its bands begin at the
    /// top again. Throws Error(invalid_input) where rows are missing or no key is left.
    void next_instant();
    /// Completes the file and puts it in place. Returns its size in bytes.
    std::uint64_t finish();
    /// The pinhole picture as it stands in part 0; complete after the last band.
    [[nodiscard]] const Image& picture() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Bytes that rows [y_begin, y_end) of a band will take in a file of this header, with all that the file says
/// of them; the pinhole picture's are not among them.
[[nodiscard]] std::uint64_t packed_bytes(const SampleHeader& header, RecordCompression compression,
                                         const RecordBand& band, int y_begin, int y_end);

/// What a reader does about damage behind the header.
enum class Damage {
    refuse,  ///< every damaged or missing scanline is an error once it is read
    salvage  ///< they are looked for when the file is opened, and left out
};

/// Reads a sample file. Every function throws Error(invalid_input), naming the file, for what is not a whole
/// and undamaged sample file; counts and windows are checked before anything is allocated.
///
/// With Damage::salvage all records are read and checked once when the file is opened. A row that is damaged
/// or missing is then as if nothing had been seen there: see stand_in_for_row. A key of which nothing is left
/// is no longer among the instants. Still refused are a damaged header, and a file of whose own instant not
/// even one row of `least_whole_share` is whole. An undamaged file reads as without.
class SampleFileReader {
  public:
    /// So that a small file cannot ask for a large picture.
    static constexpr std::size_t least_whole_share = 64;

    /// Colours are read as radiance times 2^exposure_stops; absent: the header's own, so that 1 is white.
    explicit SampleFileReader(const std::filesystem::path& path, Damage damage = Damage::refuse,
                              std::optional<double> exposure_stops = std::nullopt);
    ~SampleFileReader();
    SampleFileReader(const SampleFileReader&) = delete;
    SampleFileReader& operator=(const SampleFileReader&) = delete;
    SampleFileReader(SampleFileReader&&) = delete;
    SampleFileReader& operator=(SampleFileReader&&) = delete;

    [[nodiscard]] const SampleHeader& header() const;
    /// By which colours are read.
    [[nodiscard]] double exposure_stops() const;
    /// How many instants there are records of: the frame's own, which is number 0, and the keys.
    [[nodiscard]] std::size_t instants() const;
    [[nodiscard]] double instant_s(std::size_t instant) const;
    /// One entry per record scanline, first at y = -overscan.
    [[nodiscard]] std::span<const ScanlineFacts> scanlines(std::size_t instant = 0) const;
    /// Of all instants together.
    [[nodiscard]] std::uint64_t record_count() const;
    [[nodiscard]] std::uint64_t file_bytes() const;
    /// The record rows: [-overscan, height + overscan + 1).
    [[nodiscard]] int y_begin() const;
    [[nodiscard]] int y_end() const;
    /// The record columns: [-overscan, width + overscan + 1).
    [[nodiscard]] int x_begin() const;
    [[nodiscard]] int x_end() const;

    /// Rows [y_begin, y_end) of an instant in canonical order. Checksums, ids of paths, positions and
    /// finiteness are verified. A buffer given again is reused. Random access is allowed.
    void read(int y_begin, int y_end, RecordBand& band, std::size_t instant = 0) const;
    /// What was left out, by instant and from top to bottom; empty without Damage::salvage.
    [[nodiscard]] std::span<const LostRows> lost_rows() const;
    /// Of keys of which nothing is left.
    [[nodiscard]] std::span<const double> lost_instants_s() const;
    /// Part 0 as stored; damage in it is refused with Damage::salvage as well, since records make pictures.
    [[nodiscard]] Image picture() const;
    /// True where the file begins like a sample file (an OpenEXR file with postlens' version attribute).
    [[nodiscard]] static bool is_sample_file(const std::filesystem::path& path);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace postlens
