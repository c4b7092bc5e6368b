// Damaged sample files read with --salvage: intact rows are bit-identical to those of the undamaged file,
// damaged rows are empty, and the lost rows are reported.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>

#include "pictures/image.h"
#include "records/quadtree.h"
#include "records/sample_file.h"
#include "tests/support/command_test.h"
#include "tests/support/random_records.h"

namespace postlens::test::salvage_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int records_part = 1, scanlines_part = 2, parts_per_key = 2;

template <typename T>
T number_at(const std::string& bytes, std::size_t at) {
    T value{};
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

/// Offset of the chunk of row y of a part. A chunk begins with its part and row, as int32 each. The head of
/// the first chunk, which has y < 0, occurs nowhere before it.
std::size_t chunk_at(const std::string& bytes, int part, int y) {
    std::size_t at = std::string::npos;
    for (const std::int32_t overscan : {1, 2, 8}) {
        std::string head(8, '\0');
        head[0] = records_part;
        const std::int32_t first_row = -overscan;
        std::memcpy(head.data() + 4, &first_row, 4);
        at = std::min(at, bytes.find(head));
    }
    while (at < bytes.size()) {
        const auto here = number_at<std::int32_t>(bytes, at);
        if (here == part && number_at<std::int32_t>(bytes, at + 4) == y) return at;
        const bool deep = here % 2 == 1;
        at += deep ? 32 + number_at<std::uint64_t>(bytes, at + 8) + number_at<std::uint64_t>(bytes, at + 16)
                   : 12 + number_at<std::uint32_t>(bytes, at + 8);
    }
    ADD_FAILURE() << "no row " << y << " of part " << part;
    return 0;
}

/// Flips one bit of a row's data, after the chunk's head.
std::string with_flipped_bit(std::string bytes, int part, int y, std::size_t at = 60) {
    const std::size_t place = chunk_at(bytes, part, y) + at;
    bytes.at(place) = static_cast<char>(bytes[place] ^ 4);
    return bytes;
}

struct Written {
    RandomOptions options{.levels = 3, .probability = 0.4, .has_w = true, .has_layers = true, .keys = 2};
    SampleHeader header = full_header(9, 12, 2, options);
    std::vector<RecordBand> instants;

    Written(const fs::path& path, RecordCompression compression) {
        std::mt19937 random(8);
        for (int i = 0; i <= options.keys; ++i) instants.push_back(random_frame(random, header, options));
        SampleFileWriter writer(path, header, compression);
        for (std::size_t i = 0; i < instants.size(); ++i) {
            if (i > 0) writer.next_instant();
            writer.write(instants[i]);
        }
        writer.finish();
    }
    [[nodiscard]] int y_begin() const { return instants[0].y_begin; }
    [[nodiscard]] int y_end() const { return instants[0].y_end; }
};

RecordBand all_of(const SampleFileReader& file, std::size_t instant = 0) {
    RecordBand band;
    file.read(file.y_begin(), file.y_end(), band, instant);
    return band;
}

/// Checks that rows not in `lost` equal those of `good`, that rows in `lost` are black and infinitely far
/// away, and that every leaf has its corners.
void expect_lost(const SampleFileReader& file, std::size_t instant, const RecordBand& good,
                 const std::set<int>& lost) {
    const RecordBand band = all_of(file, instant);
    for (int y = band.y_begin; y < band.y_end; ++y) {
        const RecordBand row = rows_of_band(band, y, y + 1);
        if (!lost.contains(y)) {
            const RecordBand expected = rows_of_band(good, y, y + 1);
            EXPECT_EQ(row.offsets, expected.offsets) << y;
            EXPECT_TRUE(row.records == expected.records) << y;
            continue;
        }
        EXPECT_GE(row.records.size(), static_cast<std::size_t>(row.width()));
        for (const Record& r : row.records) {
            EXPECT_TRUE(r.z == std::numeric_limits<float>::infinity() && r.id == 0 && r.layer == 0);
            EXPECT_TRUE(r.r == 0 && r.g == 0 && r.b == 0 && r.w == Mat2{} && r.path == NodePath());
            EXPECT_EQ(r.y, static_cast<float>(y));
        }
    }
    PixelLeaves leaves;
    EXPECT_NO_THROW(find_leaves(band, band.y_begin, band.y_end - 1, leaves));
    std::size_t stated = 0;
    for (const ScanlineFacts& facts : file.scanlines(instant)) stated += facts.records;
    EXPECT_EQ(stated, band.records.size());
    // Reading in small bands gives the same records.
    RecordBand alone;
    for (int y = band.y_begin; y < band.y_end; ++y) {
        file.read(y, y + 1, alone, instant);
        EXPECT_TRUE(alone.records == rows_of_band(band, y, y + 1).records) << y;
    }
}

TEST(Salvage, AnUndamagedFileReadsAsWithout) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    const Written written(path, RecordCompression::zips);
    const SampleFileReader file(path, Damage::salvage);
    EXPECT_TRUE(file.lost_rows().empty());
    EXPECT_TRUE(file.lost_instants_s().empty());
    ASSERT_EQ(file.instants(), 3U);
    for (std::size_t i = 0; i < 3; ++i) expect_lost(file, i, written.instants[i], {});
    EXPECT_EQ(file.record_count(), SampleFileReader(path).record_count());
}

TEST(Salvage, AFlippedBitLosesItsRowAndNoOther) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr", damaged = folder.path() / "b.exr";
    for (const RecordCompression compression :
         {RecordCompression::none, RecordCompression::rle, RecordCompression::zips}) {
        const Written written(path, compression);
        const std::string bytes = bytes_of(path);
        // Tests all rows with one compression, and some rows with the others.
        const int step = compression == RecordCompression::zips ? 1 : 7;
        for (int y = written.y_begin(); y < written.y_end(); y += step) {
            for (const int part : {records_part, scanlines_part}) {
                write_bytes(damaged, with_flipped_bit(bytes, part, y, part == records_part ? 60 : 20));
                EXPECT_THROW((void)all_of(SampleFileReader(damaged)), Error);
                const SampleFileReader file(damaged, Damage::salvage);
                ASSERT_EQ(file.lost_rows().size(), 1U) << y;
                EXPECT_EQ(file.lost_rows()[0], (LostRows{0, y, y + 1}));
                expect_lost(file, 0, written.instants[0], {y});
                expect_lost(file, 1, written.instants[1], {});
            }
        }
    }
}

TEST(Salvage, NeighbouringRowsAndKeysAreLostTogether) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    const Written written(path, RecordCompression::zips);
    std::string bytes = bytes_of(path);
    for (const int y : {3, 4, 5, 9}) bytes = with_flipped_bit(bytes, records_part, y);
    bytes = with_flipped_bit(bytes, records_part + 2 * parts_per_key, 0);
    for (int y = written.y_begin(); y < written.y_end(); ++y)
        bytes = with_flipped_bit(bytes, records_part + parts_per_key, y);
    write_bytes(path, bytes);
    const SampleFileReader file(path, Damage::salvage);
    // The first key is lost completely, so the second key follows the frame's own instant.
    ASSERT_EQ(file.instants(), 2U);
    ASSERT_EQ(file.lost_instants_s().size(), 1U);
    EXPECT_EQ(file.lost_instants_s()[0], written.header.key_times_s[0]);
    EXPECT_EQ(file.header().key_times_s, std::vector<double>{written.header.key_times_s[1]});
    EXPECT_EQ(file.instant_s(1), written.header.key_times_s[1]);
    const std::vector<LostRows> expected{{0, 3, 6}, {0, 9, 10}, {1, 0, 1}};
    EXPECT_TRUE(
        std::equal(expected.begin(), expected.end(), file.lost_rows().begin(), file.lost_rows().end()));
    EXPECT_EQ(rows_text(file.lost_rows().first(2)), "rows 3-5, 9");
    expect_lost(file, 0, written.instants[0], {3, 4, 5, 9});
    expect_lost(file, 1, written.instants[2], {0});
}

TEST(Salvage, ACutOffFileGivesWhatIsWhole) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr", cut = folder.path() / "b.exr";
    const Written written(path, RecordCompression::rle);
    const std::string bytes = bytes_of(path);
    const std::size_t first_chunk = chunk_at(bytes, records_part, written.y_begin());
    std::size_t before = 0;
    std::mt19937 random(2);
    for (std::size_t length = 0; length < bytes.size(); length += 1 + random() % 19997) {
        write_bytes(cut, std::string_view(bytes).substr(0, length));
        std::set<int> lost;
        try {
            const SampleFileReader file(cut, Damage::salvage);
            EXPECT_GT(length, first_chunk);
            for (const LostRows& run : file.lost_rows()) {
                for (int y = run.y_begin; y < run.y_end; ++y)
                    if (run.instant == 0) lost.insert(y);
            }
            expect_lost(file, 0, written.instants[0], lost);
            // Rows are stored in ascending y and keys come last, so the last rows are lost.
            const std::size_t whole =
                static_cast<std::size_t>(written.y_end() - written.y_begin()) - lost.size();
            for (const int y : lost) EXPECT_GE(y, written.y_begin() + static_cast<int>(whole));
            EXPECT_GE(whole, before);
            before = whole;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            EXPECT_EQ(before, 0U) << length << " " << e.what();
        }
    }
    EXPECT_EQ(before, static_cast<std::size_t>(written.y_end() - written.y_begin()));
}

TEST(Salvage, ADamagedHeaderIsRefusedAllTheSame) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    const Written written(path, RecordCompression::none);
    const std::string bytes = bytes_of(path);
    const std::size_t chunks = 12 + 3 * 2 * static_cast<std::size_t>(written.y_end() - written.y_begin());
    const std::size_t header = chunk_at(bytes, records_part, written.y_begin()) - 8 * chunks;
    std::mt19937 random(4);
    std::size_t refused = 0;
    for (std::size_t at = 0; at < header; at += 13) {
        std::string flipped = bytes;
        flipped[at] = static_cast<char>(flipped[at] ^ (1 << (random() % 8)));
        write_bytes(path, flipped);
        bool without = false;
        try {
            const SampleFileReader file(path);
        } catch (const Error&) {
            without = true;
        }
        if (!without) continue;
        ++refused;
        EXPECT_THROW(SampleFileReader(path, Damage::salvage), Error) << at;
    }
    EXPECT_GT(refused, header / 13 / 2);
}

TEST(Salvage, TooLittleIsRefusedWhateverTheHeaderPromises) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    // One intact row of 200 is less than 1/64.
    const RandomOptions options;
    const SampleHeader header = full_header(5, 197, 1, options);
    std::mt19937 random(6);
    SampleFileWriter writer(path, header, RecordCompression::none);
    writer.write(random_frame(random, header, options));
    writer.finish();
    const std::string bytes = bytes_of(path);
    const auto cut_behind = [&](int y) {
        write_bytes(path, std::string_view(bytes).substr(0, chunk_at(bytes, records_part, y) + 4));
    };
    cut_behind(3);
    EXPECT_THROW(SampleFileReader(path, Damage::salvage), Error);
    cut_behind(8);
    const SampleFileReader file(path, Damage::salvage);
    EXPECT_EQ(file.lost_rows().size(), 1U);
    EXPECT_LT(file.lost_rows()[0].y_begin, 9);
}

class SalvageCommand : public CommandTest {
  protected:
    static constexpr int width = 64, height = 48;
    void SetUp() override {
        constexpr const char* scene = POSTLENS_SAMPLES "/scenes/motion.toml";
        const Outcome r = run({"trace", scene, "-o", in("a.exr"), "--size", "64x48", "--overscan", "8",
                               "--for-shutter", "0:1", "--quiet"});
        ASSERT_EQ(r.exit_code, 0) << r.err;
        write_bytes(in("b.exr"), with_flipped_bit(with_flipped_bit(bytes_of(in("a.exr")), records_part, 20),
                                                  records_part, 21));
    }
    Image made(const std::string& subcommand, const std::string& frame, std::vector<std::string> more,
               json* said = nullptr) {
        more.insert(more.begin(), {subcommand, in(frame), "-o", in("o.exr"), "--json"});
        const Outcome r = run(more);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        if (r.exit_code != 0) return Image(width, height);
        if (said != nullptr) *said = json::parse(r.out);
        return read_image(in("o.exr"));
    }
    /// The first and the last row that differ; an empty range if all rows are equal.
    static std::pair<int, int> differing(const Image& a, const Image& b) {
        std::pair<int, int> out{a.height, -1};
        for (int y = 0; y < a.height; ++y) {
            if (std::equal(a.pixel(0, y), a.pixel(0, y) + 3 * a.width, b.pixel(0, y))) continue;
            out.first = std::min(out.first, y);
            out.second = std::max(out.second, y);
        }
        return out;
    }
    static json salvaged(const json& said) {
        for (const json& w : said.at("warnings"))
            if (w.at("code") == "salvaged") return w;
        return nullptr;
    }
};

TEST_F(SalvageCommand, PicturesAreEqualBeyondTheReachOfWhatIsLost) {
    struct Case {
        std::string subcommand;
        std::vector<std::string> words;
        double reach_px;
    };
    // The widest CoC for f/8 and a focus at 6 m: of the background at infinity, and of the nearest object.
    const json info = json::parse(run({"info", in("a.exr"), "--json"}).out);
    const double film_per_pitch =
        info["film_distance_mm"].get<double>() / info["pixel_pitch_mm"].get<double>();
    const double nearest_m = info["nearest_m"].get<double>();
    const double focal_m = info["focal_length_mm"].get<double>() / 1000;
    const double coc_px =
        film_per_pitch * (focal_m / 8) * std::max(1 / 6.0, std::abs(1 / nearest_m - 1 / 6.0));
    const std::vector<std::string> lens{"--f-number", "8", "--focus", "6"};
    for (Case c :
         {Case{"image", {}, 0}, Case{"focus", lens, coc_px / 2 + 2},
          Case{"focus", {"--f-number", "8", "--focus", "6", "--method", "layers"}, coc_px / 2 + 2}}) {
        const Image good = made(c.subcommand, "a.exr", c.words);
        std::vector<std::string> words = c.words;
        words.emplace_back("--salvage");
        json said;
        EXPECT_EQ(differing(good, made(c.subcommand, "a.exr", words, &said)), (std::pair{height, -1}));
        EXPECT_EQ(salvaged(said), nullptr);

        words = c.words;
        words.insert(words.begin(), {c.subcommand, in("b.exr"), "-o", in("refused.exr")});
        refused(words, ExitCode::invalid_input, "damaged in scanline 2");

        words = c.words;
        words.emplace_back("--salvage");
        const Image rest = made(c.subcommand, "b.exr", words, &said);
        const auto [first, last] = differing(good, rest);
        EXPECT_GE(first, 19 - static_cast<int>(c.reach_px)) << c.subcommand;
        EXPECT_LE(first, 20) << c.subcommand;  // the lost rows differ
        EXPECT_LE(last, 21 + static_cast<int>(c.reach_px)) << c.subcommand;
        EXPECT_GT(first, 0);
        EXPECT_LT(last, height - 1);
        for (const float v : rest.rgb) ASSERT_TRUE(std::isfinite(v) && v >= 0) << v;
        const json warning = salvaged(said);
        ASSERT_NE(warning, nullptr);
        EXPECT_NE(warning.at("text").get<std::string>().find("rows 20-21 lost"), std::string::npos)
            << warning;
        EXPECT_NEAR(warning.at("share").get<double>(), 2.0 / (height + 16 + 1), 1e-9);
    }
}

TEST_F(SalvageCommand, EveryReaderOfSampleFilesTakesIt) {
    const std::vector<std::vector<std::string>> commands{
        {"image", in("b.exr"), "-o", in("o.png")},
        {"focus", in("b.exr"), "-o", in("o.exr"), "--f-number", "8", "--focus", "6", "--method",
         "lightfield"},
        {"motionblur", in("b.exr"), "-o", in("o.exr"), "--shutter", "0:1"},
        {"motionblur", in("b.exr"), "-o", in("o.exr"), "--shutter", "0:1", "--method", "lightfield"},
        {"shoot", in("b.exr"), "-o", in("o.exr"), "--shutter", "0:1", "--f-number", "8", "--focus", "6",
         "--views", "8"},
        {"info", in("b.exr")},
        {"records", in("b.exr"), "--at", "9,20"},
        {"sweep", in("b.exr"), "-o", in("lenses"), "--f-number", "8", "--focus", "6"}};
    for (std::vector<std::string> words : commands) {
        const Outcome without = run(words);
        EXPECT_EQ(without.exit_code, 3) << words[0] << " " << without.err;
        words.emplace_back("--salvage");
        const Outcome with = run(words);
        EXPECT_EQ(with.exit_code, 0) << words[0] << " " << with.err;
        EXPECT_NE(with.err.find("rows 20-21 lost"), std::string::npos) << words[0] << " " << with.err;
    }
    // With --strict, a salvaged file counts as insufficient.
    EXPECT_EQ(run({"focus", in("b.exr"), "-o", in("o.exr"), "--f-number", "8", "--focus", "6", "--salvage",
                   "--strict"})
                  .exit_code,
              6);
}

TEST_F(SalvageCommand, CutOffFilesGiveTheirUpperPart) {
    const Image good = made("image", "a.exr", {});
    const std::string bytes = bytes_of(in("a.exr"));
    write_bytes(in("c.exr"), std::string_view(bytes).substr(0, chunk_at(bytes, records_part, 30) + 40));
    refused({"image", in("c.exr"), "-o", in("x.exr")}, ExitCode::invalid_input, "c.exr");
    json said;
    const Image rest = made("image", "c.exr", {"--salvage"}, &said);
    // Row 29 of the records is intact, but its metadata, which are stored with row 30, are lost.
    EXPECT_EQ(differing(good, rest).first, 28);
    EXPECT_EQ(rest.pixel(5, 31)[0], 0);
    EXPECT_NE(salvaged(said).at("text").get<std::string>().find("rows 29-56 lost"), std::string::npos)
        << said;
    // A file without its header cannot be salvaged.
    write_bytes(in("c.exr"), std::string_view(bytes).substr(0, 2000));
    refused({"image", in("c.exr"), "-o", in("x.exr"), "--salvage"}, ExitCode::invalid_input, "c.exr");
}

TEST_F(SalvageCommand, IsForSampleFilesOnly) {
    const std::string picture = POSTLENS_TEST_DATA "/exr/deep_alpha.exr";
    const ExitCode three = ExitCode::invalid_input;
    const std::string part = "not a postlens sample file";
    refused({"image", picture, "-o", in("x.exr"), "--salvage"}, three, part);
    refused({"focus", picture, "-o", in("x.exr"), "--f-number", "2", "--focus", "4", "--salvage"}, three,
            part);
    refused({"motionblur", picture, "-o", in("x.exr"), "--shutter", "0:1", "--salvage"}, three, part);
    refused({"info", picture, "--salvage"}, three, part);
    refused({"info", POSTLENS_SAMPLES "/scenes/motion.toml", "--salvage"}, three, part);
}

}  // namespace
}  // namespace postlens::test::salvage_test
