#include <OpenEXR/ImfHeader.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <tbb/enumerable_thread_specific.h>

#include "core/error.h"
#include "core/files/output_file.h"
#include "core/threads.h"
#include "pictures/exr/exr_output.h"
#include "records/file/record_scanline.h"
#include "records/file/sample_file_header.h"
#include "records/quadtree.h"
#include "records/sample_file.h"

namespace postlens {
namespace {

using namespace layout;

/// Number of rows that are packed in parallel before they are written: few, to limit memory, but enough to
/// keep all threads busy.
constexpr int rows_per_batch = 64;

struct PackedRow {
    Bytes counts, data;  ///< bytes for the file, compressed if that makes them smaller
    std::uint64_t data_bytes = 0;
    ScanlineFacts facts;
};

/// Buffers of one thread. Each row is packed in the same memory, which thus stays in the cache.
struct RowPacker {
    RowPacker(int width, RecordChannels channels) : bytes(width, channels) {}
    ScanlineBytes bytes;
    ChunkCodec codec;
    Bytes packed;
};

ScanlineFacts facts_of(std::span<const Record> records) {
    ScanlineFacts facts;
    facts.records = static_cast<std::uint32_t>(records.size());
    for (const Record& r : records) {
        if (std::isinf(r.z)) continue;
        facts.nearest_z = std::min(facts.nearest_z, r.z);
        facts.farthest_z = std::max(facts.farthest_z, r.z);
    }
    return facts;
}

}  // namespace

struct SampleFileWriter::Impl {
    Impl(const std::filesystem::path& path, SampleHeader sample_header, RecordCompression compression)
        : header(std::move(sample_header)),
          channels{header.has_w, header.has_layers, header.has_bend, header.has_marks},
          codec(codec_of(compression)),
          picture_codec(compression == RecordCompression::zips ? ChunkCompression::zip : codec),
          name(path.string()) {
        check_sample_header(header, name);
        static_cast<void>(motion_of_text(motion_text(header.motion), name));
        window = data_window(records_part, header);
        next_y = window.y_min;
        picture = Image(header.width, header.height);
        file.emplace(path);
        const auto headers = exr_headers_of(header, codec, picture_codec);
        std::vector<std::size_t> chunks;
        chunks.reserve(headers.size());
        for (const Imf::Header& h : headers) chunks.push_back(static_cast<std::size_t>(h.chunkCount()));
        output.emplace(file->temporary_path(), name, headers, chunks);
        last_row.x_begin = window.x_min;
        last_row.x_end = window.x_max + 1;
        picture_checksums.resize(static_cast<std::size_t>(header.height));
    }

    SampleHeader header;
    RecordChannels channels;
    ChunkCompression codec, picture_codec;
    std::string name;
    Window window;
    std::optional<OutputFile> file;
    std::optional<ExrOutput> output;
    Image picture;
    std::size_t instant = 0;  ///< instant that is being written: the frame's own, then the keys
    int next_y = 0;           ///< next row of records to write
    RecordBand last_row;      ///< row next_y - 1; while a band is written, also the row after it
    std::optional<ScanlineFacts> last_facts;  ///< of row next_y - 1, not yet written
    std::vector<std::uint64_t> picture_checksums;
    std::vector<PackedRow> rows;
    tbb::enumerable_thread_specific<RowPacker> packers{
        [this] { return RowPacker(window.x_max + 1 - window.x_min, channels); }};
    bool finished = false;

    void check_band(const RecordBand& band) const;
    void end_instant();
    void pack_row(const RecordBand& band, int y, PackedRow& row);
    void compute_picture_row(const RecordBand& band, int y);
    void write_batch(const RecordBand& band, int y_begin, int y_end);
    void write_scanline_row(int y, const ScanlineFacts& facts);
    void write_picture_block(int block);
    [[nodiscard]] Bytes picture_planes(int y_begin, int y_end) const;
    void keep_last_row(const RecordBand& band);
    void add_to_last_row(const RecordBand& band, int y);
};

void SampleFileWriter::Impl::check_band(const RecordBand& band) const {
    const bool shape = band.y_begin == next_y && band.y_end > band.y_begin &&
                       band.y_end <= window.y_max + 1 && band.x_begin == window.x_min &&
                       band.x_end == window.x_max + 1;
    const std::size_t pixels =
        static_cast<std::size_t>(band.width()) * static_cast<std::size_t>(band.height());
    if (!shape || band.offsets.size() != pixels + 1 || band.offsets.front() != 0 ||
        band.offsets.back() != band.records.size() ||
        !std::is_sorted(band.offsets.begin(), band.offsets.end())) {
        fail(ExitCode::invalid_input,
             "{}: band of records does not fit (got rows {} to {}, columns {} to {}; expected rows from {}, "
             "columns {} to {})",
             name, band.y_begin, band.y_end, band.x_begin, band.x_end, next_y, window.x_min,
             window.x_max + 1);
    }
}

void SampleFileWriter::Impl::pack_row(const RecordBand& band, int y, PackedRow& row) {
    const std::span<const std::uint32_t> offsets =
        std::span(band.offsets)
            .subspan(band.pixel(band.x_begin, y), static_cast<std::size_t>(band.width()) + 1);
    const std::span<const Record> records = band.records;
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
        const int x = band.x_begin + static_cast<int>(i);
        const auto pixel = records.subspan(offsets[i], offsets[i + 1] - offsets[i]);
        if (const char* problem = problem_of_pixel(pixel, x, y, channels)) {
            fail(ExitCode::invalid_input, "{}: cannot store the records of pixel ({}, {}): {}", name, x, y,
                 problem);
        }
    }
    const std::uint32_t count = offsets.back() - offsets.front();
    if (count > largest_chunk_bytes / bytes_per_record(channels)) {
        fail(ExitCode::invalid_input, "{}: too many records in row {} (got {}; expected at most {})", name, y,
             count, largest_chunk_bytes / bytes_per_record(channels));
    }
    RowPacker& packer = packers.local();
    ScanlineBytes& bytes = packer.bytes;
    bytes.pack(y, band.x_begin, offsets, records);
    row.facts = facts_of(records.subspan(offsets.front(), count));
    row.facts.checksum = bytes.checksum();
    row.data_bytes = bytes.channel_data().size();
    const auto compress = [&](ByteView raw, Bytes& to) {
        const ByteView packed = packer.codec.compress(codec, raw, packer.packed);
        to.assign(packed.begin(), packed.end());
    };
    compress(bytes.counts(), row.counts);
    compress(bytes.channel_data(), row.data);
}

Bytes SampleFileWriter::Impl::picture_planes(int y_begin, int y_end) const {
    Bytes bytes(static_cast<std::size_t>(y_end - y_begin) * static_cast<std::size_t>(header.width) * 12);
    std::uint8_t* to = bytes.data();
    for (int y = y_begin; y < y_end; ++y) {
        for (const std::size_t channel : {2U, 1U, 0U}) {  // B, G, R
            const float* from = picture.pixel(0, y) + channel;
            for (int x = 0; x < header.width; ++x, from += 3, to += sizeof(float)) {
                std::memcpy(to, from, sizeof(float));
            }
        }
    }
    return bytes;
}

/// Computes row y of the pinhole image. A pixel's colour is a weighted mean of the samples in the pixel and
/// on its edges. Those on its lower edge belong to row y + 1 of the records. Therefore, `band` must contain
/// the rows y and y + 1.
void SampleFileWriter::Impl::compute_picture_row(const RecordBand& band, int y) {
    if (instant > 0 || y < 0 || y >= header.height) return;
    const std::span<float> rgb(picture.pixel(0, y), static_cast<std::size_t>(header.width) * 3);
    picture_row(band, y, 0, header.width, rgb);
    for (const float v : rgb) {
        if (!std::isfinite(v)) {
            fail(ExitCode::invalid_input,
                 "{}: the colours of a pixel in row {} add up beyond what a float holds", name, y);
        }
    }
    picture_checksums[static_cast<std::size_t>(y)] = picture_row_checksum(picture_planes(y, y + 1));
}

void SampleFileWriter::Impl::write_scanline_row(int y, const ScanlineFacts& facts) {
    const bool in_picture = instant == 0 && y >= 0 && y < header.height;
    const ScanlineRow row{facts, in_picture ? picture_checksums[static_cast<std::size_t>(y)] : 0};
    output->write_flat_chunk(part_index(scanlines_part, instant), y, row.bytes(y));
}

/// Completes a recorded instant after its last row of records. The summary of a row is written one row later
/// than its records, because it contains a checksum of pixels whose lower corners belong to the next row. So
/// the last summary is written here.
void SampleFileWriter::Impl::end_instant() {
    if (next_y != window.y_max + 1) {
        fail(ExitCode::invalid_input, "{}: records are missing (got rows up to {}; expected up to {})", name,
             next_y, window.y_max + 1);
    }
    if (last_facts) write_scanline_row(window.y_max, *last_facts);
    last_facts.reset();
}

void SampleFileWriter::Impl::write_picture_block(int block) {
    const int y_begin = block * rows_per_chunk(picture_codec);
    const int y_end = std::min(y_begin + rows_per_chunk(picture_codec), header.height);
    const Bytes planes = picture_planes(y_begin, y_end);
    RowPacker& packer = packers.local();
    output->write_flat_chunk(picture_part, y_begin,
                             packer.codec.compress(picture_codec, planes, packer.packed));
}

void SampleFileWriter::Impl::write_batch(const RecordBand& band, int y_begin, int y_end) {
    const auto count = static_cast<std::size_t>(y_end - y_begin);
    if (rows.size() < count) rows.resize(count);
    parallel_for(count, [&](std::size_t i) { pack_row(band, y_begin + static_cast<int>(i), rows[i]); });
    if (y_begin == band.y_begin && y_begin > window.y_min) {
        add_to_last_row(band, y_begin);
        compute_picture_row(last_row, y_begin - 1);
    }
    // Computes the rows of the pinhole image that are now complete. Image row y - 1 needs the rows y - 1 and
    // y of the records, because they contain the upper and lower corners of its pixels. The image row above
    // the first row of `band` has already been computed.
    parallel_for(count, [&](std::size_t i) {
        const int y = y_begin + static_cast<int>(i);
        if (y > band.y_begin) compute_picture_row(band, y - 1);
    });
    // Writes the rows of records to the file. The rows of the pinhole image are written in blocks, each as
    // soon as the records that it needs are written. So the order of the data in the file does not depend on
    // the number of rows per call.
    const int block_rows = rows_per_chunk(picture_codec);
    for (std::size_t i = 0; i < count; ++i) {
        const int y = y_begin + static_cast<int>(i);
        output->write_deep_chunk(part_index(records_part, instant), y, rows[i].counts, rows[i].data,
                                 rows[i].data_bytes);
        if (last_facts) write_scanline_row(y - 1, *last_facts);
        last_facts = rows[i].facts;
        const bool ends_block =
            instant == 0 && y >= 1 && y <= header.height && (y % block_rows == 0 || y == header.height);
        if (ends_block) write_picture_block((y - 1) / block_rows);
    }
}

void SampleFileWriter::Impl::keep_last_row(const RecordBand& band) {
    const std::size_t first = band.pixel(band.x_begin, band.y_end - 1);
    last_row.y_begin = band.y_end - 1;
    last_row.y_end = band.y_end;
    last_row.offsets.assign(band.offsets.begin() + static_cast<std::ptrdiff_t>(first), band.offsets.end());
    const std::uint32_t base = last_row.offsets.front();
    for (std::uint32_t& offset : last_row.offsets) offset -= base;
    last_row.records.assign(band.records.begin() + base, band.records.end());
}

void SampleFileWriter::Impl::add_to_last_row(const RecordBand& band, int y) {
    const std::size_t first = band.pixel(band.x_begin, y);
    const std::uint32_t begin = band.offsets[first];
    const auto base = static_cast<std::uint32_t>(last_row.records.size());
    for (std::size_t i = first + 1; i <= first + static_cast<std::size_t>(band.width()); ++i) {
        last_row.offsets.push_back(band.offsets[i] - begin + base);
    }
    const std::uint32_t end = band.offsets[first + static_cast<std::size_t>(band.width())];
    last_row.records.insert(last_row.records.end(), band.records.begin() + begin, band.records.begin() + end);
    last_row.y_end = y + 1;
}

SampleFileWriter::SampleFileWriter(const std::filesystem::path& path, const SampleHeader& header,
                                   RecordCompression compression)
    : impl_(std::make_unique<Impl>(path, header, compression)) {}

SampleFileWriter::~SampleFileWriter() = default;

void SampleFileWriter::write(const RecordBand& band) {
    impl_->check_band(band);
    for (int y = band.y_begin; y < band.y_end; y += rows_per_batch) {
        impl_->write_batch(band, y, std::min(y + rows_per_batch, band.y_end));
    }
    impl_->keep_last_row(band);
    impl_->next_y = band.y_end;
}

void SampleFileWriter::next_instant() {
    if (impl_->instant == impl_->header.key_times_s.size()) {
        fail(ExitCode::invalid_input, "{}: records of an instant that the header does not name (expected {})",
             impl_->name, 1 + impl_->header.key_times_s.size());
    }
    impl_->end_instant();
    ++impl_->instant;
    impl_->next_y = impl_->window.y_min;
}

std::uint64_t SampleFileWriter::finish() {
    if (impl_->instant != impl_->header.key_times_s.size() || impl_->finished) {
        fail(ExitCode::invalid_input, "{}: records are missing (got {} instants; expected {})", impl_->name,
             1 + impl_->instant, 1 + impl_->header.key_times_s.size());
    }
    impl_->end_instant();
    const std::uint64_t size = impl_->output->finish();
    impl_->file->commit();
    impl_->finished = true;
    return size;
}

const Image& SampleFileWriter::picture() const {
    return impl_->picture;
}

}  // namespace postlens
