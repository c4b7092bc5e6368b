// Sample files: what the writer refuses, and files that cannot be written.
#include <OpenEXR/ImfStandardAttributes.h>
#include <cmath>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/job.h"
#include "records/sample_file.h"
#include "tests/records/sample_frames.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::sample_file_refusals_test {
namespace {

namespace fs = std::filesystem;

TEST(SampleFile, RecordsThatCannotBeStoredAreRefused) {
    const TemporaryFolder folder;
    const Frame good = random_frame(4, 4, 0, {});
    const std::vector<std::pair<const char*, std::function<void(Record&)>>> damages{
        {"colour", [](Record& r) { r.g = std::numeric_limits<float>::quiet_NaN(); }},
        {"z'", [](Record& r) { r.z = -1; }},
        {"upper-left", [](Record& r) { r.layer = 1; }},
        {"W channels", [](Record& r) { r.path = NodePath().child(NodePath::Bounce::reflected); }},
        {"upper-left", [](Record& r) { r.x += 0.5F; }},
    };
    for (const auto& [text, damage] : damages) {
        Frame frame = good;
        damage(frame.records.records[12]);
        const auto [code, message] =
            error_of([&] { write_frame(folder.path() / "a.exr", frame, RecordCompression::none); });
        EXPECT_EQ(code, ExitCode::invalid_input);
        EXPECT_NE(message.find(text), std::string::npos) << message;
        EXPECT_NE(message.find("a.exr"), std::string::npos);
        EXPECT_EQ(folder.file_count(), 0U);
    }
}

TEST(SampleFile, ColoursThatAddUpBeyondAFloatAreRefused) {
    const TemporaryFolder folder;
    Frame frame = random_frame(4, 4, 0, {.has_w = true});
    for (Record& r : frame.records.records) r.r = r.path.bits() == 0 ? 3e38F : 0;
    write_frame(folder.path() / "a.exr", frame, RecordCompression::none);
    for (Record& r : frame.records.records) r.r = 3e38F;
    const auto [code, message] =
        error_of([&] { write_frame(folder.path() / "b.exr", frame, RecordCompression::none); });
    EXPECT_EQ(code, ExitCode::invalid_input);
    EXPECT_NE(message.find("add up beyond"), std::string::npos) << message;
    EXPECT_EQ(folder.file_count(), 1U);
}

TEST(SampleFile, BandsMustFollowEachOther) {
    const TemporaryFolder folder;
    const Frame frame = random_frame(4, 6, 1, {});
    SampleFileWriter writer(folder.path() / "a.exr", frame.header, RecordCompression::rle);
    writer.write(rows_of_band(frame.records, -1, 2));
    EXPECT_EQ(error_of([&] { writer.write(rows_of_band(frame.records, 3, 5)); }).first,
              ExitCode::invalid_input);
    EXPECT_EQ(error_of([&] { writer.write(rows_of_band(frame.records, -1, 2)); }).first,
              ExitCode::invalid_input);
    EXPECT_EQ(error_of([&] { writer.finish(); }).first, ExitCode::invalid_input);
    writer.write(rows_of_band(frame.records, 2, 8));
    writer.finish();
    EXPECT_EQ(SampleFileReader(folder.path() / "a.exr").record_count(), frame.records.records.size());
}

TEST(SampleFile, AMissingInstantIsRefusedByWriterAndReader) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    const Frame frame = random_frame(4, 6, 0, {.keys = 2});
    SampleFileWriter writer(path, frame.header, RecordCompression::rle);
    const auto refused = [](const auto& act, const char* part) {
        const auto [code, text] = error_of(act);
        EXPECT_EQ(code, ExitCode::invalid_input) << part;
        EXPECT_NE(text.find(part), std::string::npos) << text;
    };
    writer.write(rows_of_band(frame.records, 0, 3));
    refused([&] { writer.next_instant(); }, "records are missing");
    writer.write(rows_of_band(frame.records, 3, 7));
    refused([&] { writer.finish(); }, "got 1 instants; expected 3");
    writer.next_instant();
    refused([&] { writer.write(rows_of_band(frame.keys[0], 3, 7)); }, "does not fit");
    writer.write(frame.keys[0]);
    writer.next_instant();
    refused([&] { writer.finish(); }, "records are missing");
    writer.write(frame.keys[1]);
    refused([&] { writer.next_instant(); }, "does not name");
    EXPECT_FALSE(fs::exists(path));
    writer.finish();
    const SampleFileReader reader(path);
    RecordBand band;
    refused([&] { reader.read(0, 1, band, 3); }, "no such instant");
    refused([&] { (void)reader.scanlines(3); }, "no such instant");
    refused([&] { (void)reader.instant_s(3); }, "no such instant");
}

TEST(SampleFile, AsManyKeysAsThereMayBe) {
    const TemporaryFolder folder;
    Frame frame = random_frame(2, 2, 0, {.keys = 64});
    write_frame(folder.path() / "a.exr", frame, RecordCompression::zips);
    const SampleFileReader reader(folder.path() / "a.exr");
    ASSERT_EQ(reader.instants(), 65U);
    RecordBand band;
    reader.read(0, 3, band, 64);
    expect_equal_bands(band, frame.keys[63]);
}

TEST(SampleFile, BadHeadersAreRefused) {
    const TemporaryFolder folder;
    const SampleHeader good = full_header(4, 4, 0, {});
    const std::vector<std::pair<const char*, std::function<void(SampleHeader&)>>> damages{
        {"width", [](auto& h) { h.width = 0; }},
        {"height", [](auto& h) { h.height = 1 << 20; }},
        {"overscan", [](auto& h) { h.overscan_px = -1; }},
        {"levels", [](auto& h) { h.subdivide_levels = 11; }},
        {"size with overscan",
         [](auto& h) {
             h.width = 20000;
             h.subdivide_levels = 10;
         }},
        {"pitch", [](auto& h) { h.pixel_pitch_mm = 0; }},
        {"film distance", [](auto& h) { h.film_distance_mm = std::nan(""); }},
        {"camera", [](auto& h) { h.world_from_camera = glm::dmat4(0); }},
        {"f-number", [](auto& h) { h.f_number = -2; }},
        {"motion",
         [](auto& h) {
             h.motion.objects[3] = {{{.time_s = std::nan("")}}, {}, 1};
         }},
        {"id 0", [](auto& h) { h.object_names[0] = "nothing"; }},
        {"version", [](auto& h) { h.version = 1; }},
        {"another than the frame's",
         [](auto& h) {
             h.key_times_s = {0, h.time_s};
         }},
        {"growing",
         [](auto& h) {
             h.key_times_s = {1, 1};
         }},
        {"growing",
         [](auto& h) {
             h.key_times_s = {1, 0.5};
         }},
        {"key instant", [](auto& h) { h.key_times_s = {std::nan("")}; }},
        {"number of key instants",
         [](auto& h) {
             for (int k = 1; k <= 65; ++k) h.key_times_s.push_back(k);
         }},
        {"sufficient shutter", [](auto& h) { h.sufficient.shutter_close_s.reset(); }},
        {"shutter closing", [](auto& h) { h.sufficient.shutter_close_s = 0.05; }},
        {"shutter opening", [](auto& h) { h.sufficient.shutter_open_s = std::nan(""); }},
    };
    for (const auto& [text, damage] : damages) {
        SampleHeader header = good;
        damage(header);
        const auto [code, message] = error_of(
            [&] { const SampleFileWriter writer(folder.path() / "a.exr", header, RecordCompression::none); });
        EXPECT_EQ(code, ExitCode::invalid_input) << text;
        EXPECT_NE(message.find(text), std::string::npos) << message;
    }
    EXPECT_EQ(folder.file_count(), 0U);
}

TEST(SampleFile, AnInterruptedWriterLeavesTheOlderFile) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    const Frame frame = random_frame(4, 100, 0, {});
    write_frame(path, frame, RecordCompression::rle);
    const std::string before = bytes_of(path);
    const auto [code, text] = error_of([&] {
        Job job;
        const JobScope scope(job);
        SampleFileWriter writer(path, frame.header, RecordCompression::none);
        writer.write(rows_of_band(frame.records, 0, 50));
        job.cancel();
        writer.write(rows_of_band(frame.records, 50, 101));
    });
    EXPECT_EQ(code, ExitCode::interrupted);
    { const SampleFileWriter unfinished(path, frame.header, RecordCompression::none); }
    EXPECT_EQ(bytes_of(path), before);
    EXPECT_EQ(folder.file_count(), 1U);
}

TEST(SampleFile, WritingWhereNothingCanBeWrittenSaysSo) {
    const TemporaryFolder folder;
    fs::create_directory(folder.path() / "folder");
    const SampleHeader header = full_header(4, 4, 0, {});
    for (const fs::path& path : {folder.path() / "missing" / "a.exr", folder.path() / "folder",
                                 fs::path("/proc/postlens_cannot_write.exr")}) {
        const auto [code, text] =
            error_of([&] { const SampleFileWriter writer(path, header, RecordCompression::none); });
        EXPECT_EQ(code, ExitCode::cannot_write) << path;
        EXPECT_EQ(text.rfind(path.string(), 0), 0U) << text;
    }
}

TEST(SampleFile, AFullDiskIsAnErrorAndLeavesNothing) {
    const TemporaryFolder folder;
    const Frame frame = random_frame(40, 40, 0, {});
    for (const RecordCompression compression : all_compressions) {
        for (const rlim_t limit_bytes : {100U, 5000U, 20000U}) {
            const auto [code, text] = error_of([&] {
                const FileSizeLimit limit(limit_bytes);
                write_frame(folder.path() / "a.exr", frame, compression, {9});
            });
            EXPECT_EQ(code, ExitCode::cannot_write);
            EXPECT_NE(text.find("a.exr: cannot write"), std::string::npos) << text;
        }
    }
    EXPECT_EQ(folder.file_count(), 0U);
}

TEST(SampleFile, IsRecognisedByItsVersionAttribute) {
    const TemporaryFolder folder;
    write_frame(folder.path() / "a.exr", random_frame(4, 4, 0, {}), RecordCompression::rle);
    EXPECT_TRUE(SampleFileReader::is_sample_file(folder.path() / "a.exr"));
    write_image(folder.path() / "b.exr", Image(4, 4));
    EXPECT_FALSE(SampleFileReader::is_sample_file(folder.path() / "b.exr"));
    EXPECT_FALSE(SampleFileReader::is_sample_file(folder.path() / "missing.exr"));
    EXPECT_FALSE(SampleFileReader::is_sample_file(folder.path()));
}

}  // namespace
}  // namespace postlens::test::sample_file_refusals_test
