#include "records/coarser_file.h"

#include <gtest/gtest.h>

#include "records/sample_file.h"
#include "tests/records/sample_frames.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::coarser_file_test {
namespace {

constexpr RandomOptions everything{
    .levels = 2, .has_w = true, .has_layers = true, .has_bend = true, .has_marks = true, .keys = 2};

/// What remains of `fine` in a file with pixels `by` times as wide: found record by record, not row by row.
RecordBand corners(const RecordBand& fine, const SampleHeader& coarse, int by) {
    const int o = coarse.overscan_px;
    RecordBand out{
        .x_begin = -o, .x_end = coarse.width + o + 1, .y_begin = -o, .y_end = coarse.height + o + 1};
    for (int y = out.y_begin; y < out.y_end; ++y) {
        for (int x = out.x_begin; x < out.x_end; ++x) {
            for (Record record : fine.records) {
                if (record.x != static_cast<float>(by * x) || record.y != static_cast<float>(by * y))
                    continue;
                record.x = static_cast<float>(x);
                record.y = static_cast<float>(y);
                out.records.push_back(record);
            }
            out.offsets.push_back(static_cast<std::uint32_t>(out.records.size()));
        }
    }
    return out;
}

TEST(CoarserFile, HasTheSamplesOfEveryFewPixelCorners) {
    const TemporaryFolder folder;
    const auto fine = folder.path() / "fine.exr", coarse = folder.path() / "coarse.exr";
    const Frame frame = random_frame(37, 26, 5, everything);
    write_frame(fine, frame, RecordCompression::zips);
    for (const int by : {1, 2, 3, 7}) {
        write_coarser_file(SampleFileReader(fine, Damage::refuse, 0.0), by, coarse);
        const SampleFileReader file(coarse);
        EXPECT_EQ(file.header().width, 37 / by);
        EXPECT_EQ(file.header().height, 26 / by);
        EXPECT_EQ(file.header().overscan_px, 5 / by);
        EXPECT_EQ(file.header().subdivide_levels, 0);
        EXPECT_DOUBLE_EQ(file.header().pixel_pitch_mm, by * frame.header.pixel_pitch_mm);
        EXPECT_EQ(file.instants(), 1U);
        RecordBand read;
        file.read(file.y_begin(), file.y_end(), read);
        expect_equal_bands(read, corners(frame.records, file.header(), by));
    }
}

TEST(CoarserFile, RecordsAtCornersAreCounted) {
    const TemporaryFolder folder;
    const Frame frame = random_frame(9, 20, 1, everything);
    write_frame(folder.path() / "fine.exr", frame, RecordCompression::none);
    const SampleFileReader file(folder.path() / "fine.exr");
    const auto at_corners = corners(frame.records, frame.header, 1).records.size();
    ASSERT_LT(at_corners, frame.records.records.size());
    EXPECT_EQ(corner_records(file), static_cast<double>(at_corners));  // in all of so few rows
}

/// The exposure of the header must not become part of the radiance.
TEST(CoarserFile, KeepsRadiance) {
    const TemporaryFolder folder;
    const auto fine = folder.path() / "fine.exr", coarse = folder.path() / "coarse.exr";
    Frame frame = random_frame(8, 8, 0, {});
    frame.header.exposure_stops = 3;
    write_frame(fine, frame, RecordCompression::none);
    write_coarser_file(SampleFileReader(fine, Damage::refuse, 0.0), 2, coarse);
    const SampleFileReader file(coarse, Damage::refuse, 0.0);
    EXPECT_EQ(file.header().exposure_stops, 3);
    RecordBand read;
    file.read(file.y_begin(), file.y_end(), read);
    expect_equal_bands(read, corners(frame.records, file.header(), 2));
}

TEST(CoarserFile, OfTooFewPixelsIsRefused) {
    const TemporaryFolder folder;
    const auto fine = folder.path() / "fine.exr", coarse = folder.path() / "coarse.exr";
    write_frame(fine, random_frame(8, 3, 0, {}), RecordCompression::none);
    const SampleFileReader file(fine, Damage::refuse, 0.0);
    for (const int by : {4, 0, -1}) {
        EXPECT_THROW(write_coarser_file(file, by, coarse), Error) << by;
        EXPECT_FALSE(std::filesystem::exists(coarse));
    }
}

}  // namespace
}  // namespace postlens::test::coarser_file_test
