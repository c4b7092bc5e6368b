// Sample files: what is written is read, for any bands and number of threads.
#include "records/sample_file.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "core/job.h"
#include "tests/records/sample_frames.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::sample_file_test {
namespace {

namespace fs = std::filesystem;

void expect_equal_headers(const SampleHeader& a, const SampleHeader& b) {
    EXPECT_EQ(a.version, b.version);
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.overscan_px, b.overscan_px);
    EXPECT_EQ(a.projection, b.projection);
    EXPECT_EQ(a.film_distance_mm, b.film_distance_mm);
    EXPECT_EQ(a.pixel_pitch_mm, b.pixel_pitch_mm);
    EXPECT_EQ(a.focal_length_mm, b.focal_length_mm);
    EXPECT_EQ(a.f_number, b.f_number);
    EXPECT_EQ(a.focus_m, b.focus_m);
    EXPECT_EQ(a.exposure_s, b.exposure_s);
    EXPECT_EQ(a.world_from_camera, b.world_from_camera);
    EXPECT_EQ(a.time_s, b.time_s);
    EXPECT_EQ(a.subdivide_levels, b.subdivide_levels);
    EXPECT_EQ(a.subdivide_threshold, b.subdivide_threshold);
    EXPECT_EQ(a.max_depth, b.max_depth);
    EXPECT_EQ(a.min_contribution, b.min_contribution);
    EXPECT_EQ(a.scene_name, b.scene_name);
    EXPECT_EQ(a.scene_sha256, b.scene_sha256);
    EXPECT_EQ(a.metres_per_unit, b.metres_per_unit);
    EXPECT_EQ(a.object_names, b.object_names);
    EXPECT_EQ(a.moving_ids, b.moving_ids);
    EXPECT_EQ(a.lights_move, b.lights_move);
    EXPECT_EQ(a.motion, b.motion);
    EXPECT_EQ(a.has_w, b.has_w);
    EXPECT_EQ(a.has_layers, b.has_layers);
    EXPECT_EQ(a.has_bend, b.has_bend);
    EXPECT_EQ(a.has_marks, b.has_marks);
    EXPECT_EQ(a.sufficient.smallest_f_number, b.sufficient.smallest_f_number);
    EXPECT_EQ(a.sufficient.nearest_focus_m, b.sufficient.nearest_focus_m);
    EXPECT_EQ(a.sufficient.farthest_focus_m, b.sufficient.farthest_focus_m);
    EXPECT_EQ(a.sufficient.shutter_open_s, b.sufficient.shutter_open_s);
    EXPECT_EQ(a.sufficient.shutter_close_s, b.sufficient.shutter_close_s);
    EXPECT_EQ(a.key_times_s, b.key_times_s);
}

struct Case {
    int width, height, overscan_px;
    RandomOptions options;
};

std::vector<Case> round_trip_cases() {
    return {
        {1, 1, 0, {}},
        {5, 3, 0, {.has_w = true}},
        {4, 21, 2, {.has_layers = true}},
        {33, 40, 3, {.levels = 1, .has_w = true, .has_layers = true}},
        {33, 40, 3, {.levels = 1, .has_w = true, .has_layers = true, .has_bend = true}},
        {33, 40, 3, {.levels = 1, .has_w = true, .has_layers = true, .has_bend = true, .has_marks = true}},
        {9, 7, 0, {.levels = 2, .has_marks = true}},
        {9, 7, 1, {.levels = 5, .probability = 0.4, .has_w = true, .has_layers = true}},
        {100, 70, 5, {.levels = 2, .probability = 0.2, .has_w = true}},
        {1, 1, 0, {.keys = 1}},
        {33, 40, 3, {.levels = 1, .has_w = true, .has_layers = true, .keys = 3}},
    };
}

TEST(SampleFile, RoundTripsEverything) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    for (const Case& c : round_trip_cases()) {
        const Frame frame = random_frame(c.width, c.height, c.overscan_px, c.options);
        for (const RecordCompression compression : all_compressions) {
            const std::uint64_t size = write_frame(path, frame, compression, {7, 1, 13});
            EXPECT_EQ(size, fs::file_size(path));
            const SampleFileReader reader(path);
            expect_equal_headers(reader.header(), frame.header);
            EXPECT_EQ(reader.file_bytes(), size);
            std::size_t records = frame.records.records.size();
            for (const RecordBand& key : frame.keys) records += key.records.size();
            EXPECT_EQ(reader.record_count(), records);
            ASSERT_EQ(reader.instants(), 1 + frame.keys.size());
            EXPECT_EQ(reader.instant_s(0), frame.header.time_s);
            EXPECT_EQ(reader.y_begin(), frame.records.y_begin);
            EXPECT_EQ(reader.y_end(), frame.records.y_end);
            EXPECT_EQ(reader.x_begin(), frame.records.x_begin);
            EXPECT_EQ(reader.x_end(), frame.records.x_end);
            RecordBand band;
            reader.read(reader.y_begin(), reader.y_end(), band);
            expect_equal_bands(band, frame.records);
            // Random access: reads bands of 5 rows from the last to the first, into the same buffer.
            for (int end = reader.y_end(); end > reader.y_begin(); end -= 5) {
                const int begin = std::max(end - 5, reader.y_begin());
                reader.read(begin, end, band);
                expect_equal_bands(band, rows_of_band(frame.records, begin, end));
            }
            EXPECT_EQ(reader.picture().rgb, picture_of(frame).rgb);
            for (std::size_t k = 0; k < frame.keys.size(); ++k) {
                EXPECT_EQ(reader.instant_s(k + 1), frame.header.key_times_s[k]);
                ASSERT_EQ(reader.scanlines(k + 1).size(), reader.scanlines().size());
                reader.read(reader.y_begin(), reader.y_end(), band, k + 1);
                expect_equal_bands(band, frame.keys[k]);
                const int y = reader.y_end() - 1;
                reader.read(y, y + 1, band, k + 1);
                expect_equal_bands(band, rows_of_band(frame.keys[k], y, y + 1));
                EXPECT_EQ(reader.scanlines(k + 1).back().records, band.records.size());
            }
        }
    }
}

TEST(SampleFile, OrthographicAndEmptyOptionalFieldsRoundTrip) {
    const TemporaryFolder folder;
    Frame frame = random_frame(3, 2, 0, {});
    SampleHeader h;
    h.width = 3;
    h.height = 2;
    h.projection = Projection::orthographic;
    h.pixel_pitch_mm = 1000;
    frame.header = h;
    write_frame(folder.path() / "a.exr", frame, RecordCompression::rle);
    expect_equal_headers(SampleFileReader(folder.path() / "a.exr").header(), h);
}

TEST(SampleFile, WriterKeepsThePictureItStored) {
    const TemporaryFolder folder;
    const Frame frame = random_frame(20, 35, 1, {.levels = 2});
    SampleFileWriter writer(folder.path() / "a.exr", frame.header, RecordCompression::zips);
    writer.write(frame.records);
    EXPECT_EQ(writer.picture().rgb, picture_of(frame).rgb);
    writer.finish();
    EXPECT_EQ(SampleFileReader(folder.path() / "a.exr").picture().rgb, writer.picture().rgb);
}

TEST(SampleFile, BytesDependOnNeitherThreadsNorBands) {
    const TemporaryFolder folder;
    const Frame frame = random_frame(50, 150, 2, {.levels = 1, .has_w = true, .keys = 1});
    for (const RecordCompression compression : all_compressions) {
        std::string first;
        for (const int threads : {1, 5}) {
            const ThreadLimit limit(threads);
            for (const std::vector<int>& heights : {std::vector<int>{1}, {1000}, {16}, {3, 70, 1}}) {
                write_frame(folder.path() / "a.exr", frame, compression, heights);
                const std::string bytes = bytes_of(folder.path() / "a.exr");
                if (first.empty()) first = bytes;
                ASSERT_TRUE(bytes == first) << threads << ' ' << heights.front();
                RecordBand band;
                const SampleFileReader reader(folder.path() / "a.exr");
                reader.read(reader.y_begin(), reader.y_end(), band);
                expect_equal_bands(band, frame.records);
                reader.read(reader.y_begin(), reader.y_end(), band, 1);
                expect_equal_bands(band, frame.keys[0]);
            }
        }
    }
}

TEST(SampleFile, ScanlineFactsDescribeEachRow) {
    const TemporaryFolder folder;
    Frame frame = random_frame(6, 5, 1, {.has_w = true});
    for (Record& r : frame.records.records) {
        if (r.y == 2) r.z = std::numeric_limits<float>::infinity();
    }
    write_frame(folder.path() / "a.exr", frame, RecordCompression::rle);
    const SampleFileReader reader(folder.path() / "a.exr");
    ASSERT_EQ(reader.scanlines().size(), 8U);
    for (int y = reader.y_begin(); y < reader.y_end(); ++y) {
        const ScanlineFacts& facts = reader.scanlines()[static_cast<std::size_t>(y - reader.y_begin())];
        const RecordBand row = rows_of_band(frame.records, y, y + 1);
        float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
        for (const Record& r : row.records) {
            if (std::isinf(r.z)) continue;
            nearest = std::min(nearest, r.z);
            farthest = std::max(farthest, r.z);
        }
        EXPECT_EQ(facts.records, row.records.size());
        EXPECT_EQ(facts.nearest_z, nearest);
        EXPECT_EQ(facts.farthest_z, farthest);
    }
}

}  // namespace
}  // namespace postlens::test::sample_file_test
