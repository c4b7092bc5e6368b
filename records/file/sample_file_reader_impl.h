// Implementation of SampleFileReader, shared by several files.
#pragma once

#include <cstdint>
#include <optional>
#include <tbb/enumerable_thread_specific.h>
#include <utility>
#include <vector>

#include "core/error.h"
#include "records/file/record_scanline.h"
#include "records/file/sample_file_layout.h"
#include "records/sample_file.h"

namespace postlens {
namespace layout {

/// Location of a scanline of records in the file, in bytes: first the compressed numbers of records per
/// pixel, then the compressed records.
struct DeepChunk {
    std::uint64_t counts_at = 0, counts_bytes = 0, data_bytes = 0;
};

/// One recorded instant: the positions of its chunks in the file, and the summary of each scanline.
struct Instant {
    double time_s = 0;
    std::size_t number =
        0;  ///< in the file; more than the index in `instants` if earlier instants were removed
    std::vector<std::uint64_t> record_chunks, scanline_chunks;
    std::vector<ScanlineFacts> facts;
    std::vector<std::uint8_t> lost;  ///< per row: 1 if the row is damaged and replaced
};

/// Scratch memory of one thread.
struct Workplace {
    Workplace(int width, RecordChannels channels)
        : bytes(width, channels), offsets(static_cast<std::size_t>(width) + 1) {}
    ScanlineBytes bytes;
    std::vector<std::uint32_t> offsets;
    Bytes packed;
    ChunkCodec codec;
    RecordBand row;  ///< a row that is read alone
    std::vector<std::uint32_t> stand_in_offsets;
    std::vector<Record> stand_ins;
};

}  // namespace layout

struct SampleFileReader::Impl {
    using DeepChunk = layout::DeepChunk;
    using Instant = layout::Instant;
    using Workplace = layout::Workplace;

    Impl(const std::filesystem::path& path, Damage on_damage, std::optional<double> asked_stops);

    InputFile file;
    Damage damage;
    SampleHeader header;
    double exposure_stops = 0;
    double gain = 1;  ///< factor for the colours of records and of the picture
    RecordChannels channels;
    Window window;
    ChunkCompression codec = ChunkCompression::none, picture_codec = ChunkCompression::none;
    std::vector<std::uint64_t> picture_chunks;
    std::vector<std::uint64_t> picture_checksums;  ///< per row of the raster
    std::vector<Instant> instants;                 ///< the frame's own, then the keys
    std::uint64_t record_count = 0;
    std::vector<LostRows> lost_runs;
    std::vector<double> lost_instants_s;
    /// Scratch memory of each thread, kept between reads to avoid allocations.
    mutable std::optional<tbb::enumerable_thread_specific<Workplace>> workplaces;

    [[noreturn]] void fail_damaged(int y, const char* what) const {
        fail(ExitCode::invalid_input, "{}: damaged in scanline {} ({})", file.name(), y, what);
    }
    [[nodiscard]] std::size_t row_index(int y) const { return static_cast<std::size_t>(y - window.y_min); }

    void read_chunk_tables(std::uint64_t at);
    void read_scanlines(std::size_t instant);
    [[nodiscard]] ScanlineFacts read_scanline(std::size_t instant, int y);
    void find_lost_rows();
    void replace_lost_rows();
    void count_records();
    void check_record_count() const;
    /// Reads a row of records into `work.row`.
    void read_alone(std::size_t instant, int y, Workplace& work) const;
    /// Makes the records that replace the damaged row y, in `work`: samples of rays that hit nothing. There
    /// is one at the upper left corner of each pixel. If row y - 1 is intact, there are also some at the
    /// lower corners of its quadtree cells, which are stored in row y.
    void find_stand_ins(std::size_t instant, int y, Workplace& work) const;
    void place_stand_ins(std::size_t instant, int y, std::uint32_t base, Workplace& work,
                         RecordBand& band) const;
    /// Reads the header of the OpenEXR chunk that begins at position `at` of the file. Returns the position
    /// and the size, in bytes, of the data that follow. Throws unless the chunk is row y of `part` and has at
    /// most `most_bytes`.
    [[nodiscard]] std::pair<std::uint64_t, std::uint64_t> flat_chunk(int part, std::uint64_t at, int y,
                                                                     std::uint64_t most_bytes) const;
    [[nodiscard]] DeepChunk deep_chunk(std::size_t instant, int y) const;
    void read_row(int y, const ScanlineFacts& expected, const DeepChunk& chunk, std::uint32_t base,
                  Workplace& work, RecordBand& band) const;
    void check_row(int y, const ScanlineFacts& expected, RecordBand& band) const;
    [[nodiscard]] const Instant& instant_at(std::size_t instant) const;
};

}  // namespace postlens
