#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>

#include "core/threads.h"
#include "pictures/exposure.h"
#include "records/file/sample_file_header.h"
#include "records/file/sample_file_reader_impl.h"
#include "records/file/sample_header_names.h"

namespace postlens {
namespace {

using namespace layout;

/// A chunk (a compressed block of the file) is rejected if the size that it states for its uncompressed data
/// exceeds both limits: `unquestioned_bytes`, and `largest_expansion` times its packed size. So a small
/// damaged file cannot cause a large allocation.
constexpr std::uint64_t unquestioned_bytes = 64U << 20U;
constexpr std::uint64_t largest_expansion = 64;

/// Largest ratio by which a zlib stream can expand. A file is rejected if, even at this ratio, it is too
/// small for its stated number of records.
constexpr std::uint64_t best_deflate_ratio = 1032;

constexpr std::uint64_t flat_head_bytes = 12;  ///< part, y, size
constexpr std::uint64_t deep_head_bytes = 32;  ///< part, y, sizes of counts, packed data, data

template <typename T>
T load(const std::uint8_t* from) {
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
}

}  // namespace

SampleFileReader::Impl::Impl(const std::filesystem::path& path, Damage on_damage,
                             std::optional<double> asked_stops)
    : file(path), damage(on_damage) {
    const ExrHeaders headers = read_exr_headers(file, parts_of(SampleHeader::most_keys) + 1);
    header = sample_header_of(headers, file.name());
    exposure_stops = asked_stops.value_or(header.exposure_stops);
    gain = exposure_gain(exposure_stops);
    channels = {header.has_w, header.has_layers, header.has_bend, header.has_marks};
    window = data_window(records_part, header);
    workplaces.emplace(columns_of(window), channels);
    codec = *headers.parts[records_part].compression();
    picture_codec = *headers.parts[picture_part].compression();
    read_chunk_tables(headers.end);
    for (std::size_t i = 0; i < instants.size(); ++i) read_scanlines(i);
    if (damage == Damage::salvage) find_lost_rows();
    count_records();
    check_record_count();
    if (damage == Damage::salvage) replace_lost_rows();
}

const layout::Instant& SampleFileReader::Impl::instant_at(std::size_t instant) const {
    if (instant >= instants.size()) {
        fail(ExitCode::invalid_input, "{}: no such instant (got {}; expected 0 to {})", file.name(), instant,
             instants.size() - 1);
    }
    return instants[instant];
}

void SampleFileReader::Impl::read_chunk_tables(std::uint64_t at) {
    const std::size_t picture_count = chunks_of(header.height, picture_codec);
    const std::size_t rows = chunks_of(rows_of(window), codec);
    const std::uint64_t instant_bytes =
        rows * (8 + deep_head_bytes) + rows * (8 + flat_head_bytes + ScanlineRow::byte_count);
    const std::uint64_t table_bytes = 8 * (picture_count + 2 * rows * (1 + header.key_times_s.size()));
    const std::uint64_t least_bytes =
        damage == Damage::salvage
            ? at + table_bytes
            : at + picture_count * (8 + flat_head_bytes) + (1 + header.key_times_s.size()) * instant_bytes;
    if (file.size() < least_bytes) {
        fail(ExitCode::invalid_input, "{}: file is cut off (got {} bytes; expected more than {})",
             file.name(), file.size(), least_bytes);
    }
    const auto next_table = [&](std::size_t count, std::vector<std::uint64_t>& table) {
        Bytes bytes(count * 8);
        file.read_at(at, bytes);
        at += bytes.size();
        table.resize(count);
        std::memcpy(table.data(), bytes.data(), bytes.size());
    };
    next_table(picture_count, picture_chunks);
    instants.resize(1 + header.key_times_s.size());
    for (std::size_t i = 0; i < instants.size(); ++i) {
        instants[i].time_s = i == 0 ? header.time_s : header.key_times_s[i - 1];
        instants[i].number = i;
        instants[i].lost.resize(rows);
        next_table(rows, instants[i].record_chunks);
        next_table(rows, instants[i].scanline_chunks);
    }
}

std::pair<std::uint64_t, std::uint64_t> SampleFileReader::Impl::flat_chunk(int part, std::uint64_t at, int y,
                                                                           std::uint64_t most_bytes) const {
    std::array<std::uint8_t, flat_head_bytes> head{};
    file.read_at(at, head);
    const auto size = load<std::int32_t>(head.data() + 8);
    if (load<std::int32_t>(head.data()) != part || load<std::int32_t>(head.data() + 4) != y || size < 0 ||
        static_cast<std::uint64_t>(size) > most_bytes) {
        fail_damaged(y, "a chunk that does not belong there");
    }
    return {at + flat_head_bytes, static_cast<std::uint64_t>(size)};
}

void SampleFileReader::Impl::read_scanlines(std::size_t instant) {
    Instant& of = instants[instant];
    of.facts.resize(of.scanline_chunks.size());
    if (instant == 0) picture_checksums.resize(static_cast<std::size_t>(header.height));
    for (int y = window.y_min; y <= window.y_max; ++y) {
        try {
            of.facts[row_index(y)] = read_scanline(instant, y);
        } catch (const Error& e) {
            if (damage == Damage::refuse || e.code() != ExitCode::invalid_input) throw;
            of.lost[row_index(y)] = 1;
        }
    }
}

ScanlineFacts SampleFileReader::Impl::read_scanline(std::size_t instant, int y) {
    const int part = part_index(scanlines_part, instants[instant].number);
    const auto [at, size] =
        flat_chunk(part, instants[instant].scanline_chunks[row_index(y)], y, ScanlineRow::byte_count);
    std::array<std::uint8_t, ScanlineRow::byte_count> bytes{};
    if (size != bytes.size()) fail_damaged(y, "a row of part scanlines of another size");
    file.read_at(at, bytes);
    const auto row = ScanlineRow::from_bytes(bytes, y);
    if (!row) fail_damaged(y, "row of part scanlines does not match its check");
    if (row->facts.records < static_cast<std::uint32_t>(columns_of(window)))
        fail_damaged(y, "fewer records than pixels");
    if (instant == 0 && y >= 0 && y < header.height) {
        picture_checksums[static_cast<std::size_t>(y)] = row->picture_checksum;
    } else if (row->picture_checksum != 0) {
        fail_damaged(y, "a checksum of a picture where there is none");
    }
    return row->facts;
}

void SampleFileReader::Impl::count_records() {
    record_count = 0;
    for (const Instant& instant : instants) {
        for (const ScanlineFacts& facts : instant.facts) record_count += facts.records;
    }
}

void SampleFileReader::Impl::check_record_count() const {
    if (record_count * bytes_per_record(channels) / best_deflate_ratio > file.size()) {
        fail(ExitCode::invalid_input, "{}: file is damaged (got {} bytes for {} records)", file.name(),
             file.size(), record_count);
    }
}

DeepChunk SampleFileReader::Impl::deep_chunk(std::size_t instant, int y) const {
    const std::uint64_t at = instants[instant].record_chunks[row_index(y)];
    std::array<std::uint8_t, deep_head_bytes> head{};
    file.read_at(at, head);
    DeepChunk chunk;
    chunk.counts_at = at + deep_head_bytes;
    chunk.counts_bytes = load<std::uint64_t>(head.data() + 8);
    chunk.data_bytes = load<std::uint64_t>(head.data() + 16);
    const auto unpacked_bytes = load<std::uint64_t>(head.data() + 24);
    const std::uint64_t room = file.size() - chunk.counts_at;
    const auto count_table_bytes = static_cast<std::uint64_t>(columns_of(window)) * 4;
    if (load<std::int32_t>(head.data()) != part_index(records_part, instants[instant].number) ||
        load<std::int32_t>(head.data() + 4) != y) {
        fail_damaged(y, "a chunk that does not belong there");
    }
    if (chunk.counts_bytes > std::min(room, count_table_bytes) ||
        chunk.data_bytes > room - chunk.counts_bytes) {
        fail_damaged(y, "its chunk reaches beyond the end of the file");
    }
    const std::uint64_t records = instants[instant].facts[row_index(y)].records;
    if (unpacked_bytes != records * bytes_per_record(channels) || unpacked_bytes > largest_chunk_bytes ||
        chunk.data_bytes > unpacked_bytes) {
        fail_damaged(y, "its size does not match its number of records");
    }
    if (unpacked_bytes > std::max(unquestioned_bytes, largest_expansion * chunk.data_bytes)) {
        fail_damaged(y, "it claims to expand beyond reason");
    }
    return chunk;
}

void SampleFileReader::Impl::read_row(int y, const ScanlineFacts& expected, const DeepChunk& chunk,
                                      std::uint32_t base, Workplace& work, RecordBand& band) const {
    work.bytes.prepare(y, expected.records);
    const auto fill = [&](std::uint64_t at, std::uint64_t packed_bytes, std::span<std::uint8_t> raw,
                          const char* what) {
        if (packed_bytes == raw.size()) {
            file.read_at(at, raw);
            return;
        }
        work.packed.resize(packed_bytes);
        file.read_at(at, work.packed);
        if (!work.codec.decompress(codec, work.packed, raw)) fail_damaged(y, what);
    };
    fill(chunk.counts_at, chunk.counts_bytes, work.bytes.counts(), "its sample counts do not expand");
    fill(chunk.counts_at + chunk.counts_bytes, chunk.data_bytes, work.bytes.channel_data(),
         "its records do not expand");
    if (work.bytes.checksum() != expected.checksum) fail_damaged(y, "its checksum does not match");
    if (!work.bytes.unpack_offsets(work.offsets)) fail_damaged(y, "its sample counts do not add up");
    const auto records = std::span(band.records).subspan(base, expected.records);
    if (!work.bytes.unpack_records(band.x_begin, work.offsets, records)) {
        fail_damaged(y, "a position is not a multiple of 1/1024 px inside its pixel");
    }
    const std::size_t first = band.pixel(band.x_begin, y);
    // The caller has already set the row's first and last offset.
    for (std::size_t i = 1; i + 1 < work.offsets.size(); ++i)
        band.offsets[first + i] = base + work.offsets[i];
    check_row(y, expected, band);
}

void SampleFileReader::Impl::check_row(int y, const ScanlineFacts& expected, RecordBand& band) const {
    const std::span<Record> records = band.records;
    float nearest_z = std::numeric_limits<float>::infinity();
    float farthest_z = 0;
    for (int x = band.x_begin; x < band.x_end; ++x) {
        const std::size_t k = band.pixel(x, y);
        const auto pixel = records.subspan(band.offsets[k], band.offsets[k + 1] - band.offsets[k]);
        if (!std::is_sorted(pixel.begin(), pixel.end(), canonical_before)) {
            std::sort(pixel.begin(), pixel.end(), canonical_before);
        }
        if (const char* problem = problem_of_pixel(pixel, x, y, channels)) {
            fail(ExitCode::invalid_input, "{}: invalid records in pixel ({}, {}): {}", file.name(), x, y,
                 problem);
        }
        for (const Record& r : pixel) {
            if (std::isinf(r.z)) continue;
            nearest_z = std::min(nearest_z, r.z);
            farthest_z = std::max(farthest_z, r.z);
        }
    }
    if (nearest_z != expected.nearest_z || farthest_z != expected.farthest_z) {
        fail_damaged(y, "its nearest and farthest z' are not as stated");
    }
}

SampleFileReader::SampleFileReader(const std::filesystem::path& path, Damage damage,
                                   std::optional<double> exposure_stops)
    : impl_(std::make_unique<Impl>(path, damage, exposure_stops)) {}
SampleFileReader::~SampleFileReader() = default;

const SampleHeader& SampleFileReader::header() const {
    return impl_->header;
}
RecordCompression SampleFileReader::compression() const {
    if (impl_->codec == ChunkCompression::none) return RecordCompression::none;
    return impl_->codec == ChunkCompression::rle ? RecordCompression::rle : RecordCompression::zips;
}

double SampleFileReader::exposure_stops() const {
    return impl_->exposure_stops;
}
std::size_t SampleFileReader::instants() const {
    return impl_->instants.size();
}
double SampleFileReader::instant_s(std::size_t instant) const {
    return impl_->instant_at(instant).time_s;
}
std::span<const ScanlineFacts> SampleFileReader::scanlines(std::size_t instant) const {
    return impl_->instant_at(instant).facts;
}
std::uint64_t SampleFileReader::record_count() const {
    return impl_->record_count;
}
std::uint64_t SampleFileReader::file_bytes() const {
    return impl_->file.size();
}
std::span<const LostRows> SampleFileReader::lost_rows() const {
    return impl_->lost_runs;
}
std::span<const double> SampleFileReader::lost_instants_s() const {
    return impl_->lost_instants_s;
}
int SampleFileReader::y_begin() const {
    return impl_->window.y_min;
}
int SampleFileReader::y_end() const {
    return impl_->window.y_max + 1;
}
int SampleFileReader::x_begin() const {
    return impl_->window.x_min;
}
int SampleFileReader::x_end() const {
    return impl_->window.x_max + 1;
}

void SampleFileReader::read(int y_begin, int y_end, RecordBand& band, std::size_t instant) const {
    const Impl& impl = *impl_;
    const Instant& of = impl.instant_at(instant);
    if (y_begin < this->y_begin() || y_end > this->y_end() || y_begin > y_end) {
        fail(ExitCode::invalid_input, "{}: no such rows (got {} to {}; expected {} to {})", impl.file.name(),
             y_begin, y_end, this->y_begin(), this->y_end());
    }
    const auto rows = static_cast<std::size_t>(y_end - y_begin);
    std::vector<DeepChunk> chunks(rows);
    std::vector<std::uint32_t> bases(rows);
    std::uint64_t total = 0;
    for (std::size_t i = 0; i < rows; ++i) {
        const int y = y_begin + static_cast<int>(i);
        if (of.lost[impl.row_index(y)] == 0) chunks[i] = impl.deep_chunk(instant, y);
        bases[i] = static_cast<std::uint32_t>(total);
        total += of.facts[impl.row_index(y)].records;
        if (total > std::numeric_limits<std::uint32_t>::max()) {
            fail(ExitCode::invalid_input, "{}: rows {} to {} hold more records than can be read at once",
                 impl.file.name(), y_begin, y_end);
        }
    }
    band.x_begin = x_begin();
    band.x_end = x_end();
    band.y_begin = y_begin;
    band.y_end = y_end;
    try {
        band.offsets.resize(rows * static_cast<std::size_t>(band.width()) + 1);
        for (std::size_t i = 0; i < rows; ++i)
            band.offsets[i * static_cast<std::size_t>(band.width())] = bases[i];
        band.offsets.back() = static_cast<std::uint32_t>(total);
        band.records.resize(total);
        parallel_for(rows, [&](std::size_t i) {
            const int y = y_begin + static_cast<int>(i);
            Workplace& work = impl.workplaces->local();
            if (of.lost[impl.row_index(y)] != 0) {
                impl.place_stand_ins(instant, y, bases[i], work, band);
            } else {
                impl.read_row(y, of.facts[impl.row_index(y)], chunks[i], bases[i], work, band);
            }
            if (impl.gain == 1) return;
            const std::uint32_t end = i + 1 < rows ? bases[i + 1] : static_cast<std::uint32_t>(total);
            for (std::uint32_t k = bases[i]; k < end; ++k) {
                for (float* v : {&band.records[k].r, &band.records[k].g, &band.records[k].b})
                    *v = static_cast<float>(static_cast<double>(*v) * impl.gain);
            }
        });
    } catch (const std::bad_alloc&) {
        fail(ExitCode::out_of_memory, "{}: not enough memory for rows {} to {} (needs {} MB)",
             impl.file.name(), y_begin, y_end, total * sizeof(Record) >> 20U);
    }
}

Image SampleFileReader::picture() const {
    const Impl& impl = *impl_;
    const int width = impl.header.width;
    const int height = impl.header.height;
    const int step = rows_per_chunk(impl.picture_codec);
    const std::size_t row_bytes = static_cast<std::size_t>(width) * 12;
    Image image(width, height);
    image.exposure_stops = impl.exposure_stops;
    struct Work {
        Bytes packed, planes;
        ChunkCodec codec;
    };
    tbb::enumerable_thread_specific<Work> workplaces;
    parallel_for(impl.picture_chunks.size(), [&](std::size_t block) {
        Work& work = workplaces.local();
        const int y_begin = static_cast<int>(block) * step;
        const int y_end = std::min(y_begin + step, height);
        work.planes.resize(row_bytes * static_cast<std::size_t>(y_end - y_begin));
        const auto [at, size] =
            impl.flat_chunk(picture_part, impl.picture_chunks[block], y_begin, work.planes.size());
        work.packed.resize(size);
        impl.file.read_at(at, work.packed);
        if (!work.codec.decompress(impl.picture_codec, work.packed, work.planes)) {
            impl.fail_damaged(y_begin, "its picture does not expand");
        }
        for (int y = y_begin; y < y_end; ++y) {
            const ByteView row =
                ByteView(work.planes).subspan(static_cast<std::size_t>(y - y_begin) * row_bytes, row_bytes);
            if (picture_row_checksum(row) != impl.picture_checksums[static_cast<std::size_t>(y)]) {
                impl.fail_damaged(y, "its picture's checksum does not match");
            }
            const std::uint8_t* from = row.data();
            for (const std::size_t channel : {2U, 1U, 0U}) {  // B, G, R
                float* to = image.pixel(0, y) + channel;
                for (int x = 0; x < width; ++x, to += 3, from += sizeof(float)) {
                    *to = load<float>(from);
                    if (!std::isfinite(*to))
                        impl.fail_damaged(y, "its picture has a value that is not finite");
                    if (impl.gain != 1) *to = static_cast<float>(static_cast<double>(*to) * impl.gain);
                }
            }
        }
    });
    return image;
}

bool SampleFileReader::is_sample_file(const std::filesystem::path& path) {
    try {
        const InputFile file(path);
        const ExrHeaders headers = read_exr_headers(file, 1);
        return !headers.parts.empty() && headers.parts.front().get_int(attribute::version_name).has_value();
    } catch (const Error&) {
        return false;
    }
}

}  // namespace postlens
