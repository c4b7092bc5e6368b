#include "records/sample_file.h"

#include <Imath/half.h>
#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIDManifest.h>
#include <OpenEXR/ImfIDManifestAttribute.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <random>
#include <string>

#include "core/error.h"
#include "core/job.h"
#include "core/threads.h"
#include "records/quadtree.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;
using test::RandomOptions;
using test::TemporaryFolder;

constexpr std::array all_compressions{RecordCompression::none, RecordCompression::rle,
                                      RecordCompression::zips};

struct Frame {
    SampleHeader header;
    RecordBand records;
    std::vector<RecordBand> keys;  ///< the records of the header's key instants
};

Frame random_frame(int width, int height, int overscan_px, const RandomOptions& options, unsigned seed = 1) {
    std::mt19937 random(seed);
    Frame frame{test::full_header(width, height, overscan_px, options), {}, {}};
    frame.records = test::random_frame(random, frame.header, options);
    for (int k = 0; k < options.keys; ++k) {
        frame.keys.push_back(test::random_frame(random, frame.header, options));
    }
    return frame;
}

/// Writes a frame in bands of the given heights, which are repeated.
std::uint64_t write_frame(const fs::path& path, const Frame& frame, RecordCompression compression,
                          const std::vector<int>& heights = {1000000}) {
    SampleFileWriter writer(path, frame.header, compression);
    const auto write_instant = [&](const RecordBand& records) {
        std::size_t i = 0;
        for (int y = records.y_begin; y < records.y_end; ++i) {
            const int end = std::min(y + heights[i % heights.size()], records.y_end);
            writer.write(test::rows_of_band(records, y, end));
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

std::string bytes_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

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

void expect_equal_bands(const RecordBand& a, const RecordBand& b) {
    EXPECT_EQ(a.x_begin, b.x_begin);
    EXPECT_EQ(a.x_end, b.x_end);
    EXPECT_EQ(a.y_begin, b.y_begin);
    EXPECT_EQ(a.y_end, b.y_end);
    ASSERT_EQ(a.offsets, b.offsets);
    ASSERT_EQ(a.records.size(), b.records.size());
    for (std::size_t i = 0; i < a.records.size(); ++i) ASSERT_EQ(a.records[i], b.records[i]) << i;
}

/// The image of the records, computed by the function that all readers use.
Image picture_of(const Frame& frame) {
    Image image(frame.header.width, frame.header.height);
    for (int y = 0; y < image.height; ++y) {
        picture_row(frame.records, y, 0, image.width,
                    {image.pixel(0, y), static_cast<std::size_t>(image.width) * 3});
    }
    return image;
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
                expect_equal_bands(band, test::rows_of_band(frame.records, begin, end));
            }
            EXPECT_EQ(reader.picture().rgb, picture_of(frame).rgb);
            for (std::size_t k = 0; k < frame.keys.size(); ++k) {
                EXPECT_EQ(reader.instant_s(k + 1), frame.header.key_times_s[k]);
                ASSERT_EQ(reader.scanlines(k + 1).size(), reader.scanlines().size());
                reader.read(reader.y_begin(), reader.y_end(), band, k + 1);
                expect_equal_bands(band, frame.keys[k]);
                const int y = reader.y_end() - 1;
                reader.read(y, y + 1, band, k + 1);
                expect_equal_bands(band, test::rows_of_band(frame.keys[k], y, y + 1));
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
        for (const int threads : {1, 2, 5}) {
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
        const RecordBand row = test::rows_of_band(frame.records, y, y + 1);
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

// What other programs see
// -------------------------------------------------------------------------------------

TEST(SampleFile, OpenExrReadsThePicture) {
    const TemporaryFolder folder;
    const Frame frame = random_frame(37, 50, 2, {.levels = 1});
    const Image expected = picture_of(frame);
    for (const RecordCompression compression : all_compressions) {
        write_frame(folder.path() / "a.exr", frame, compression);
        Imf::MultiPartInputFile file((folder.path() / "a.exr").c_str());
        ASSERT_EQ(file.parts(), 3);
        EXPECT_TRUE(file.partComplete(0) && file.partComplete(1) && file.partComplete(2));
        Imf::InputPart part(file, 0);
        EXPECT_EQ(part.header().name(), "picture");
        Image image(37, 50);
        Imf::FrameBuffer buffer;
        char* base = reinterpret_cast<char*>(image.rgb.data());
        for (const auto& [name, offset] : {std::pair("R", 0), {"G", 4}, {"B", 8}}) {
            buffer.insert(name, Imf::Slice(Imf::FLOAT, base + offset, 12, 12 * 37));
        }
        part.setFrameBuffer(buffer);
        part.readPixels(0, 49);
        EXPECT_EQ(image.rgb, expected.rgb);
    }
}

TEST(SampleFile, OpenImageIoReadsThePicture) {
    const TemporaryFolder folder;
    const Frame frame = random_frame(30, 20, 3, {.levels = 1});
    write_frame(folder.path() / "a.exr", frame, RecordCompression::zips);
    EXPECT_EQ(read_image(folder.path() / "a.exr").rgb, picture_of(frame).rgb);
}

/// All values of one channel of a deep part, in file order.
template <typename T>
std::vector<T> read_deep_channel(const fs::path& path, const char* name, Imf::PixelType type,
                                 std::vector<unsigned>& counts, int of_part = 1) {
    Imf::MultiPartInputFile file(path.c_str());
    Imf::DeepScanLineInputPart part(file, of_part);
    const auto& window = part.header().dataWindow();
    const int width = window.max.x - window.min.x + 1;
    const int height = window.max.y - window.min.y + 1;
    counts.assign(static_cast<std::size_t>(width * height), 0);
    std::vector<T*> pointers(counts.size(), nullptr);
    const auto origin = static_cast<std::ptrdiff_t>(window.min.y) * width + window.min.x;
    Imf::DeepFrameBuffer buffer;
    buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data() - origin), 4,
                                             4 * static_cast<std::size_t>(width)));
    buffer.insert(name, Imf::DeepSlice(type, reinterpret_cast<char*>(pointers.data() - origin), sizeof(T*),
                                       sizeof(T*) * static_cast<std::size_t>(width), sizeof(T)));
    part.setFrameBuffer(buffer);
    part.readPixelSampleCounts(window.min.y, window.max.y);
    std::size_t total = 0;
    for (const unsigned c : counts) total += c;
    std::vector<T> values(total);
    T* at = values.data();
    for (std::size_t i = 0; i < counts.size(); ++i) {
        pointers[i] = at;
        at += counts[i];
    }
    part.readPixels(window.min.y, window.max.y);
    return values;
}

TEST(SampleFile, OpenExrFindsThePartsOfEveryKey) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    const Frame frame = random_frame(12, 9, 1, {.levels = 1, .keys = 2});
    for (const RecordCompression compression : all_compressions) {
        write_frame(path, frame, compression);
        Imf::MultiPartInputFile file(path.c_str());
        ASSERT_EQ(file.parts(), 7);
        for (int part = 0; part < 7; ++part) EXPECT_TRUE(file.partComplete(part)) << part;
        EXPECT_EQ(file.header(3).name(), "records.k1");
        EXPECT_EQ(file.header(6).name(), "scanlines.k2");
        for (int part = 3; part < 7; ++part) {
            EXPECT_EQ(file.header(part).typedAttribute<Imf::DoubleAttribute>("postlens.time_s").value(),
                      frame.header.key_times_s[part < 5 ? 0 : 1]);
        }
        std::vector<unsigned> counts;
        const std::vector<float> z = read_deep_channel<float>(path, "Z", Imf::FLOAT, counts, 5);
        ASSERT_EQ(z.size(), frame.keys[1].records.size());
        for (std::size_t i = 0; i < z.size(); ++i) ASSERT_EQ(z[i], frame.keys[1].records[i].z) << i;
    }
}

TEST(SampleFile, OpenExrReadsTheRecords) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    const Frame frame = random_frame(31, 17, 2, {.levels = 3, .has_w = true, .has_layers = true});
    const auto expect_channel = [&]<typename T>(const char* name, Imf::PixelType type,
                                                T (*value)(const Record&)) {
        std::vector<unsigned> counts;
        const std::vector<T> values = read_deep_channel<T>(path, name, type, counts);
        ASSERT_EQ(values.size(), frame.records.records.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            ASSERT_EQ(values[i], value(frame.records.records[i])) << name << ' ' << i;
        }
        for (std::size_t k = 0; k < counts.size(); ++k) {
            ASSERT_EQ(counts[k], frame.records.offsets[k + 1] - frame.records.offsets[k]);
        }
    };
    for (const RecordCompression compression : all_compressions) {
        write_frame(path, frame, compression);
        expect_channel(
            "R", Imf::FLOAT, +[](const Record& r) { return r.r; });
        expect_channel(
            "G", Imf::FLOAT, +[](const Record& r) { return r.g; });
        expect_channel(
            "B", Imf::FLOAT, +[](const Record& r) { return r.b; });
        expect_channel(
            "Z", Imf::FLOAT, +[](const Record& r) { return r.z; });
        expect_channel(
            "id", Imf::UINT, +[](const Record& r) { return r.id; });
        expect_channel(
            "layer", Imf::UINT, +[](const Record& r) { return r.layer; });
        expect_channel(
            "node.path", Imf::UINT, +[](const Record& r) { return r.path.bits(); });
        expect_channel(
            "W.xx", Imf::FLOAT, +[](const Record& r) { return r.w.xx; });
        expect_channel(
            "W.xy", Imf::FLOAT, +[](const Record& r) { return r.w.xy; });
        expect_channel(
            "W.yx", Imf::FLOAT, +[](const Record& r) { return r.w.yx; });
        expect_channel(
            "W.yy", Imf::FLOAT, +[](const Record& r) { return r.w.yy; });
        expect_channel(
            "sample.x", Imf::HALF, +[](const Record& r) { return Imath::half(r.x - std::floor(r.x)); });
        expect_channel(
            "sample.y", Imf::HALF, +[](const Record& r) { return Imath::half(r.y - std::floor(r.y)); });
    }
}

TEST(SampleFile, AbsentChannelsAreAbsent) {
    const TemporaryFolder folder;
    const Frame frame = random_frame(4, 4, 0, {});
    write_frame(folder.path() / "a.exr", frame, RecordCompression::none);
    const Imf::MultiPartInputFile file((folder.path() / "a.exr").c_str());
    const Imf::ChannelList& channels = file.header(1).channels();
    EXPECT_EQ(channels.findChannel("W.xx"), nullptr);
    EXPECT_EQ(channels.findChannel("layer"), nullptr);
    EXPECT_NE(channels.findChannel("sample.x"), nullptr);
}

TEST(SampleFile, StandardAttributesAreWhatOtherProgramsExpect) {
    const TemporaryFolder folder;
    const Frame frame = random_frame(300, 2, 0, {});
    write_frame(folder.path() / "a.exr", frame, RecordCompression::none);
    const Imf::MultiPartInputFile file((folder.path() / "a.exr").c_str());
    const Imf::Header& h = file.header(0);
    const auto number = [&](const char* name) { return h.typedAttribute<Imf::FloatAttribute>(name).value(); };
    EXPECT_EQ(number("nominalFocalLength"), 49.7F);
    EXPECT_EQ(number("pinholeFocalLength"), 50.1F);
    EXPECT_EQ(Imf::aperture(h), 2.8F);
    EXPECT_EQ(Imf::expTime(h), 1.0F / 48);
    EXPECT_TRUE(std::isinf(Imf::focus(h)));
    EXPECT_FLOAT_EQ(h.typedAttribute<Imf::V2fAttribute>("sensorOverallDimensions").value().x, 3.6F);
    // OpenEXR's camera has +x right, +y up, +z into the scene, and row vectors. A point 2 m in front of the
    // camera and 1 m to its right must map to (1, 0, 2).
    const glm::dvec4 world = frame.header.world_from_camera * glm::dvec4(1, 0, -2, 1);
    Imath::V3f seen;
    Imf::worldToCamera(h).multVecMatrix(
        Imath::V3f(static_cast<float>(world.x), static_cast<float>(world.y), static_cast<float>(world.z)),
        seen);
    EXPECT_NEAR(seen.x, 1, 1e-5);
    EXPECT_NEAR(seen.y, 0, 1e-5);
    EXPECT_NEAR(seen.z, 2, 1e-5);
    const Imf::IDManifest manifest(Imf::idManifest(file.header(1)));
    const std::size_t group = manifest.find("id");
    ASSERT_LT(group, manifest.size());
    EXPECT_EQ(manifest[group].find(7).text().front(), "mirror ball");
}

// Refusals when writing
// ---------------------------------------------------------------------------------------

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
    writer.write(test::rows_of_band(frame.records, -1, 2));
    EXPECT_EQ(error_of([&] { writer.write(test::rows_of_band(frame.records, 3, 5)); }).first,
              ExitCode::invalid_input);
    EXPECT_EQ(error_of([&] { writer.write(test::rows_of_band(frame.records, -1, 2)); }).first,
              ExitCode::invalid_input);
    EXPECT_EQ(error_of([&] { writer.finish(); }).first, ExitCode::invalid_input);
    writer.write(test::rows_of_band(frame.records, 2, 8));
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
    writer.write(test::rows_of_band(frame.records, 0, 3));
    refused([&] { writer.next_instant(); }, "records are missing");
    writer.write(test::rows_of_band(frame.records, 3, 7));
    refused([&] { writer.finish(); }, "got 1 instants; expected 3");
    writer.next_instant();
    refused([&] { writer.write(test::rows_of_band(frame.keys[0], 3, 7)); }, "does not fit");
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
    const SampleHeader good = test::full_header(4, 4, 0, {});
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
        writer.write(test::rows_of_band(frame.records, 0, 50));
        job.cancel();
        writer.write(test::rows_of_band(frame.records, 50, 101));
    });
    EXPECT_EQ(code, ExitCode::interrupted);
    { const SampleFileWriter unfinished(path, frame.header, RecordCompression::none); }
    EXPECT_EQ(bytes_of(path), before);
    EXPECT_EQ(folder.file_count(), 1U);
}

TEST(SampleFile, WritingWhereNothingCanBeWrittenSaysSo) {
    const TemporaryFolder folder;
    fs::create_directory(folder.path() / "folder");
    const SampleHeader header = test::full_header(4, 4, 0, {});
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
                const test::FileSizeLimit limit(limit_bytes);
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
}  // namespace postlens
