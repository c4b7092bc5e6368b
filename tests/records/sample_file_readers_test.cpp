// Sample files as other programs see them.
#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIDManifest.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include "records/sample_file.h"
#include "tests/records/sample_frames.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::sample_file_readers_test {
namespace {

namespace fs = std::filesystem;

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

}  // namespace
}  // namespace postlens::test::sample_file_readers_test
