// Random frames, written to sample files and compared.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "pictures/image.h"
#include "records/quadtree.h"
#include "records/record.h"
#include "records/sample_file.h"
#include "records/sample_header.h"
#include "tests/support/file_bytes.h"
#include "tests/support/random_records.h"

namespace postlens::test {

/// The compressions that a sample file may have.
inline constexpr std::array all_compressions{RecordCompression::none, RecordCompression::rle,
                                             RecordCompression::zips};

/// All content of a sample file.
struct Frame {
    SampleHeader header;
    RecordBand records;
    std::vector<RecordBand> keys;  ///< the records of the header's key instants
};

/// A random frame of width x height px. The same seed gives the same frame.
inline Frame random_frame(int width, int height, int overscan_px, const RandomOptions& options,
                          unsigned seed = 1) {
    std::mt19937 random(seed);
    Frame frame{full_header(width, height, overscan_px, options), {}, {}};
    frame.records = random_frame(random, frame.header, options);
    for (int k = 0; k < options.keys; ++k) {
        frame.keys.push_back(random_frame(random, frame.header, options));
    }
    return frame;
}

/// Writes a frame in bands of `heights` rows, which are repeated. Returns the number of bytes.
inline std::uint64_t write_frame(const std::filesystem::path& path, const Frame& frame,
                                 RecordCompression compression, const std::vector<int>& heights = {1000000}) {
    SampleFileWriter writer(path, frame.header, compression);
    const auto write_instant = [&](const RecordBand& records) {
        std::size_t i = 0;
        for (int y = records.y_begin; y < records.y_end; ++i) {
            const int end = std::min(y + heights[i % heights.size()], records.y_end);
            writer.write(rows_of_band(records, y, end));
            y = end;
        }
    };
    write_instant(frame.records);
    for (const RecordBand& key : frame.keys) {
        writer.next_instant();
        write_instant(key);
    }
    return writer.finish();
}

inline void expect_equal_bands(const RecordBand& a, const RecordBand& b) {
    EXPECT_EQ(a.x_begin, b.x_begin);
    EXPECT_EQ(a.x_end, b.x_end);
    EXPECT_EQ(a.y_begin, b.y_begin);
    EXPECT_EQ(a.y_end, b.y_end);
    ASSERT_EQ(a.offsets, b.offsets);
    ASSERT_EQ(a.records.size(), b.records.size());
    for (std::size_t i = 0; i < a.records.size(); ++i) ASSERT_EQ(a.records[i], b.records[i]) << i;
}

/// The image of the records, computed by the function that all readers use.
inline Image picture_of(const Frame& frame) {
    Image image(frame.header.width, frame.header.height);
    for (int y = 0; y < image.height; ++y) {
        picture_row(frame.records, y, 0, image.width,
                    {image.pixel(0, y), static_cast<std::size_t>(image.width) * 3});
    }
    return image;
}

/// The exit code and message of the error that `body` throws; `ok` and no message if it throws none.
template <typename Body>
std::pair<ExitCode, std::string> error_of(const Body& body) {
    try {
        body();
    } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        return {e.code(), e.what()};
    }
    return {ExitCode::ok, ""};
}

}  // namespace postlens::test
