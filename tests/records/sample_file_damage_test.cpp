// Damaged or forged sample files: each must be rejected with a one-line message, quickly and with little
// memory, or be read exactly like the original.
#include <OpenEXR/ImfHeader.h>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <sys/resource.h>
#include <sys/stat.h>

#include "core/error.h"
#include "core/threads.h"
#include "pictures/exr/exr_output.h"
#include "records/file/record_scanline.h"
#include "records/file/sample_file_header.h"
#include "records/sample_file.h"
#include "tests/support/file_bytes.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::sample_file_damage_test {
namespace {

namespace fs = std::filesystem;

constexpr std::array all_compressions{RecordCompression::none, RecordCompression::rle,
                                      RecordCompression::zips};

/// All content that a reader returns.
struct Content {
    RecordBand records;
    std::vector<RecordBand> keys;
    std::vector<float> picture;
    std::vector<ScanlineFacts> facts;
    std::string scene_name;
};

Content read_all(const fs::path& path) {
    const SampleFileReader reader(path);
    Content content;
    reader.read(reader.y_begin(), reader.y_end(), content.records);
    for (std::size_t k = 1; k < reader.instants(); ++k) {
        reader.read(reader.y_begin(), reader.y_end(), content.keys.emplace_back(), k);
    }
    content.picture = reader.picture().rgb;
    content.facts.assign(reader.scanlines().begin(), reader.scanlines().end());
    content.scene_name = reader.header().scene_name;
    return content;
}

bool same(const Content& a, const Content& b) {
    const bool same_facts = std::equal(
        a.facts.begin(), a.facts.end(), b.facts.begin(), b.facts.end(), [](const auto& x, const auto& y) {
            return x.records == y.records && x.nearest_z == y.nearest_z && x.farthest_z == y.farthest_z;
        });
    const bool same_keys = std::equal(
        a.keys.begin(), a.keys.end(), b.keys.begin(), b.keys.end(),
        [](const auto& x, const auto& y) { return x.offsets == y.offsets && x.records == y.records; });
    return same_facts && same_keys && a.records.offsets == b.records.offsets &&
           a.records.records == b.records.records && a.picture == b.picture && a.scene_name == b.scene_name;
}

/// Reads the file and checks that its content equals `good` unless it is rejected. Returns whether it was
/// rejected.
bool refused_or_same(const fs::path& path, const Content& good, const std::string& what) {
    try {
        EXPECT_TRUE(same(read_all(path), good)) << what << ": read as something else";
        return false;
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::invalid_input) << what << ": " << e.what();
        EXPECT_EQ(std::string(e.what()).find(path.string()), 0U) << e.what();
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        return true;
    }
}

std::string refusal_of(const fs::path& path) {
    try {
        (void)read_all(path);
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::invalid_input) << e.what();
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        return e.what();
    }
    return "accepted";
}

/// Overwrites one byte of an existing file.
void write_byte(const fs::path& path, std::size_t at, char byte) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte);
}

// Two scanlines are the fewest whose chunks can be confused.
constexpr int small_width = 3, small_height = 2;

void write_small_file(const fs::path& path, RecordCompression compression) {
    const RandomOptions options{
        .levels = 1, .probability = 0.3, .has_w = true, .has_layers = true, .keys = 1};
    std::mt19937 random(5);
    const SampleHeader header = full_header(small_width, small_height, 1, options);
    SampleFileWriter writer(path, header, compression);
    writer.write(random_frame(random, header, options));
    writer.next_instant();
    writer.write(random_frame(random, header, options));
    writer.finish();
}

/// The position after the chunk tables. The first chunk belongs to part 1 and to the scanline at -1.
std::size_t first_chunk_of(const std::string& bytes) {
    return bytes.find(std::string("\1\0\0\0\xff\xff\xff\xff", 8));
}

TEST(DamagedSampleFile, EveryTruncationIsRefused) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    for (const RecordCompression compression : all_compressions) {
        write_small_file(path, compression);
        const std::string bytes = bytes_of(path);
        for (std::size_t length = 0; length < bytes.size(); length += length < 4000 ? 37 : 101) {
            write_bytes(path, std::string_view(bytes).substr(0, length));
            EXPECT_NE(refusal_of(path), "accepted") << length;
        }
        write_bytes(path, std::string_view(bytes).substr(0, bytes.size() - 1));
        EXPECT_NE(refusal_of(path), "accepted");
    }
}

TEST(DamagedSampleFile, EveryFlippedByteIsRefusedOrHarmless) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    const ThreadLimit one(1);  // threads only cost time for files of two scanlines
    std::mt19937 random(11);
    std::string first;
    for (const RecordCompression compression : all_compressions) {
        write_small_file(path, compression);
        const Content good = read_all(path);
        const std::string bytes = bytes_of(path);
        if (first.empty()) first = bytes;
        const std::size_t chunks = first_chunk_of(bytes);
        std::size_t flipped = 0, refused = 0;
        for (std::size_t at = 0; at < bytes.size(); ++at) {
            // The headers are the same but for the compression and checksums.
            if (compression != all_compressions[0] && at < chunks && bytes[at] == first[at]) continue;
            write_byte(path, at, static_cast<char>(bytes[at] ^ (1 << (random() % 8))));
            ++flipped;
            refused += refused_or_same(path, good, "byte " + std::to_string(at)) ? 1 : 0;
            write_byte(path, at, bytes[at]);
        }
        // Only what the reader does not use may change without an error.
        EXPECT_GT(refused, flipped * 85 / 100) << flipped;
    }
}

TEST(DamagedSampleFile, ChunksOutOfPlaceAreRefused) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    for (const RecordCompression compression : all_compressions) {
        write_small_file(path, compression);
        const Content good = read_all(path);
        const std::string bytes = bytes_of(path);
        // The chunk tables are the first position with ascending file offsets. Swapped or changed entries
        // must be detected.
        const SampleFileReader reader(path);
        const std::uint64_t rows = static_cast<std::uint64_t>(reader.y_end() - reader.y_begin());
        const std::uint64_t picture_chunks = compression == RecordCompression::zips ? 1 : small_height;
        const std::uint64_t entries = 2 * reader.instants() * rows + picture_chunks;
        const std::uint64_t table = first_chunk_of(bytes) - 8 * entries;
        for (std::uint64_t i = 0; i + 1 < entries; ++i) {
            std::string swapped = bytes;
            std::swap_ranges(swapped.begin() + static_cast<std::ptrdiff_t>(table + 8 * i),
                             swapped.begin() + static_cast<std::ptrdiff_t>(table + 8 * i + 8),
                             swapped.begin() + static_cast<std::ptrdiff_t>(table + 8 * i + 8));
            write_bytes(path, swapped);
            EXPECT_TRUE(refused_or_same(path, good, "swapped chunk " + std::to_string(i)));
            for (const std::uint64_t offset :
                 {std::uint64_t{0}, ~std::uint64_t{0}, std::uint64_t{bytes.size() - 5}}) {
                std::string pointed = bytes;
                std::memcpy(pointed.data() + table + 8 * i, &offset, 8);
                write_bytes(path, pointed);
                EXPECT_TRUE(refused_or_same(path, good, "moved chunk " + std::to_string(i)));
            }
        }
    }
}

/// Writes a file with correct checksums and arbitrary records, as a malicious writer could.
class ForgedFile {
  public:
    RandomOptions options{.has_w = true};
    SampleHeader header = full_header(3, 2, 0, options);
    RecordBand records;
    /// Applied to each scanline's counts and channels before the checksum is computed.
    std::function<void(int y, ScanlineBytes&)> change_bytes = [](int, ScanlineBytes&) {};
    std::function<void(ScanlineFacts&)> change_facts = [](ScanlineFacts&) {};

    ForgedFile() {
        std::mt19937 random(3);
        records = random_frame(random, header, options);
    }

    void write(const fs::path& path) const {
        using namespace layout;
        const auto headers = exr_headers_of(header, ChunkCompression::none, ChunkCompression::none);
        std::vector<std::size_t> chunks;
        for (const Imf::Header& h : headers) chunks.push_back(static_cast<std::size_t>(h.chunkCount()));
        ExrOutput out(path, path.string(), headers, chunks);
        const Bytes picture(static_cast<std::size_t>(header.width) * 12);
        for (int y = 0; y < header.height; ++y) out.write_flat_chunk(picture_part, y, picture);
        for (int y = records.y_begin; y < records.y_end; ++y) {
            const auto offsets = std::span(records.offsets)
                                     .subspan(records.pixel(records.x_begin, y),
                                              static_cast<std::size_t>(records.width()) + 1);
            ScanlineBytes bytes(records.width(), {header.has_w, header.has_layers});
            bytes.pack(y, records.x_begin, offsets, records.records);
            change_bytes(y, bytes);
            ScanlineRow row;
            row.facts.records = offsets.back() - offsets.front();
            for (std::uint32_t i = offsets.front(); i < offsets.back(); ++i) {
                const float z = records.records[i].z;
                if (std::isinf(z)) continue;
                row.facts.nearest_z = std::min(row.facts.nearest_z, z);
                row.facts.farthest_z = std::max(row.facts.farthest_z, z);
            }
            row.facts.checksum = bytes.checksum();
            change_facts(row.facts);
            if (y < header.height) row.picture_checksum = picture_row_checksum(picture);
            out.write_deep_chunk(records_part, y, bytes.counts(), bytes.channel_data(),
                                 bytes.channel_data().size());
            out.write_flat_chunk(scanlines_part, y, row.bytes(y));
        }
        out.finish();
    }
};

TEST(ForgedSampleFile, UnchangedItReads) {
    const TemporaryFolder folder;
    const ForgedFile file;
    file.write(folder.path() / "a.exr");
    EXPECT_EQ(read_all(folder.path() / "a.exr").records.records, file.records.records);
}

TEST(ForgedSampleFile, RecordsOutOfOrderAreSorted) {
    const TemporaryFolder folder;
    ForgedFile file;
    const RecordBand sorted = file.records;
    bool shuffled = false;
    for (std::size_t k = 0; k + 1 < sorted.offsets.size(); ++k) {
        const auto begin = file.records.records.begin() + sorted.offsets[k];
        const auto end = file.records.records.begin() + sorted.offsets[k + 1];
        shuffled = shuffled || end - begin > 1;
        std::reverse(begin, end);
    }
    ASSERT_TRUE(shuffled);
    file.write(folder.path() / "a.exr");
    EXPECT_EQ(read_all(folder.path() / "a.exr").records.records, sorted.records);
}

TEST(ForgedSampleFile, ImpossibleRecordsAreRefused) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float inf = std::numeric_limits<float>::infinity();
    const std::vector<std::pair<const char*, std::function<void(Record&)>>> damages{
        {"colour", [](Record& r) { r.r = nan; }},
        {"colour", [](Record& r) { r.g = inf; }},
        {"colour", [](Record& r) { r.b = -inf; }},
        {"z'", [](Record& r) { r.z = nan; }},
        {"z'", [](Record& r) { r.z = 0; }},
        {"z'", [](Record& r) { r.z = -1; }},
        {"W", [](Record& r) { r.w.xx = nan; }},
        {"W", [](Record& r) { r.w.yx = inf; }},
        {"node.path", [](Record& r) { r.path = NodePath(0xC0); }},
        {"upper-left", [](Record& r) { r.x += 0.25F; }},
        {"primary", [](Record& r) { r.path = NodePath(1); }},
    };
    for (const auto& [text, damage] : damages) {
        ForgedFile file;
        // Changes a pixel with one record, so that no other record can replace it.
        const auto& offsets = file.records.offsets;
        std::size_t k = 0;
        while (offsets[k + 1] - offsets[k] != 1) ++k;
        damage(file.records.records[offsets[k]]);
        file.write(path);
        EXPECT_NE(refusal_of(path).find(text), std::string::npos) << text << ": " << refusal_of(path);
    }
}

TEST(ForgedSampleFile, PositionsThatAreNoOffsetsAreRefused) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    // The bit patterns are the half floats NaN, infinity, 1, -0, -0.5, 2^-24 and 1/2048.
    for (const std::uint16_t half : {0x7E00, 0x7C00, 0x3C00, 0x8000, 0xB800, 0x0001, 0x1000}) {
        ForgedFile file;
        file.change_bytes = [half](int, ScanlineBytes& bytes) {
            const auto data = bytes.channel_data();
            std::memcpy(data.data() + data.size() - 2, &half, 2);
        };
        file.write(path);
        EXPECT_NE(refusal_of(path).find("1/1024"), std::string::npos) << half;
    }
}

TEST(ForgedSampleFile, CountsThatLieAreRefused) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    for (const std::uint32_t count : {0U, 1000U, 0xFFFFFFFFU}) {
        for (const std::size_t pixel : {0U, 1U, 3U}) {
            ForgedFile file;
            file.change_bytes = [=](int, ScanlineBytes& bytes) {
                std::memcpy(bytes.counts().data() + 4 * pixel, &count, 4);
            };
            file.write(path);
            EXPECT_NE(refusal_of(path), "accepted") << count << ' ' << pixel;
        }
    }
    for (const std::uint32_t records : {0U, 3U, 1000000U, 0xFFFFFFFFU}) {
        ForgedFile file;
        file.change_facts = [=](ScanlineFacts& facts) { facts.records = records; };
        file.write(path);
        EXPECT_NE(refusal_of(path), "accepted") << records;
    }
    ForgedFile file;
    file.change_facts = [](ScanlineFacts& facts) { facts.nearest_z = 0.001F; };
    file.write(path);
    EXPECT_NE(refusal_of(path).find("nearest"), std::string::npos);
}

// AddressSanitizer delays freeing and pads allocations, so only a limit of 1 GiB is tested with it.
#if defined(__SANITIZE_ADDRESS__)
constexpr long most_kilobytes = 1024 * 1024;
#else
constexpr long most_kilobytes = 100 * 1024;
#endif

long peak_kilobytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
}

TEST(ForgedSampleFile, HugeSizesAreRefusedWithoutMemory) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    const ThreadLimit one(1);
    const long before = peak_kilobytes();
    ForgedFile file;
    file.write(path);
    const std::string good = bytes_of(path);
    // Sets each 32-bit word of the headers (windows, counts, sizes of attributes) to large numbers.
    const std::size_t header_end =
        good.find(std::string("\0\0\0\0\0\0\0\0", 8), good.find("scanlineimage", 3000));
    const std::size_t end = std::min(good.size(), header_end == std::string::npos ? good.size() : header_end);
    for (std::size_t at = 0; at + 4 <= end; ++at) {
        for (const std::int32_t number :
             {0x7FFFFFFF, 0x7FFFFFF0, 262143, 100000, -1, static_cast<int>(0x80000000)}) {
            std::string bytes = good;
            std::memcpy(bytes.data() + at, &number, 4);
            write_bytes(path, bytes);
            try {
                (void)read_all(path);
            } catch (const Error& e) {
                ASSERT_EQ(e.code(), ExitCode::invalid_input) << e.what();
            }
        }
    }
    EXPECT_LT(peak_kilobytes() - before, most_kilobytes);
}

TEST(ForeignFile, IsToldApart) {
    const TemporaryFolder folder;
    const fs::path data = fs::path(POSTLENS_TEST_DATA) / "exr";
    for (const char* name : {"deep_one_sample.exr", "deep_object_ids.exr"}) {
        ASSERT_TRUE(fs::exists(data / name));
        EXPECT_NE(refusal_of(data / name).find("not a postlens sample file"), std::string::npos) << name;
        EXPECT_FALSE(SampleFileReader::is_sample_file(data / name));
    }
    write_image(folder.path() / "flat.exr", Image(3, 3));
    EXPECT_NE(refusal_of(folder.path() / "flat.exr").find("not a postlens sample file"), std::string::npos);
    write_bytes(folder.path() / "text.exr", "This is not a picture at all.");
    EXPECT_NE(refusal_of(folder.path() / "text.exr").find("not a postlens sample file"), std::string::npos);
    write_bytes(folder.path() / "empty.exr", "");
    EXPECT_NE(refusal_of(folder.path() / "empty.exr").find("not a postlens sample file"), std::string::npos);
}

TEST(ForeignFile, AnotherVersionIsNamed) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    write_small_file(path, RecordCompression::none);
    std::string bytes = bytes_of(path);
    const std::string_view name("postlens.formatVersion\0int\0\4\0\0\0", 31);
    const std::size_t at = bytes.find(name);
    ASSERT_NE(at, std::string::npos);
    bytes[at + name.size()] = 1;
    write_bytes(path, bytes);
    EXPECT_NE(refusal_of(path).find("another version (got 1; expected 2)"), std::string::npos)
        << refusal_of(path);
    EXPECT_TRUE(SampleFileReader::is_sample_file(path));
}

TEST(ForeignFile, WhatIsNoFileIsNamed) {
    const TemporaryFolder folder;
    EXPECT_NE(refusal_of(folder.path() / "missing.exr").find("(no such file)"), std::string::npos);
    EXPECT_NE(refusal_of(folder.path()).find("a folder"), std::string::npos);
    ASSERT_EQ(::mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
    EXPECT_NE(refusal_of(folder.path() / "pipe").find("a device or pipe"), std::string::npos);
}

TEST(ForeignFile, DamagedFilesOfOthersAreRefusedQuickly) {
    const fs::path data = fs::path(POSTLENS_TEST_DATA) / "exr-damaged";
    const long before = peak_kilobytes();
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(data)) {
        if (!entry.is_regular_file()) continue;
        const auto start = std::chrono::steady_clock::now();
        EXPECT_NE(refusal_of(entry.path()), "accepted") << entry.path();
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10)) << entry.path();
        ++count;
    }
    EXPECT_GT(count, 50U);
    EXPECT_LT(peak_kilobytes() - before, 2 * most_kilobytes);
}

}  // namespace
}  // namespace postlens::test::sample_file_damage_test
