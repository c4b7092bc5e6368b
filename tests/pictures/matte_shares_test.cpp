// Cryptomattes of pictures with several bands of rows: read with the colours, or from parts of their own.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/job.h"
#include "pictures/foreign/foreign_picture.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::matte_shares_test {
namespace {

constexpr int width = 9, height = 150;  // three bands of 64 rows, ten chunks of ZIP

using Channels = std::map<std::string, std::vector<float>>;

/// Random ids and coverages of four ranks, among them equal coverages and two ranks of one surface.
struct Values {
    Channels colours, ranks_0_and_1, ranks_2_and_3;
};
Values random_values() {
    std::mt19937 random(5);
    const std::vector<float> none(static_cast<std::size_t>(width * height), 0.5F);
    Values v{{{"R", none}, {"G", none}, {"B", none}, {"Z", none}}, {}, {}};
    for (std::size_t i = 0; i < none.size(); ++i)
        v.colours["R"][i] = static_cast<float>(random() % 100) / 100;
    for (auto* ranks : {&v.ranks_0_and_1, &v.ranks_2_and_3}) {
        const std::string layer = ranks == &v.ranks_0_and_1 ? "CryptoObject00." : "CryptoObject01.";
        for (const char* channel : {"R", "G", "B", "A"}) {
            std::vector<float>& values = (*ranks)[layer + channel];
            for (std::size_t i = 0; i < none.size(); ++i) {
                const bool is_id = *channel == 'R' || *channel == 'B';
                values.push_back(
                    is_id ? std::bit_cast<float>(static_cast<std::uint32_t>(0x3f000000U + random() % 6))
                          : static_cast<float>(random() % 5) / 16);
            }
        }
    }
    return v;
}

Channels joined(Channels a, const Channels& b) {
    a.insert(b.begin(), b.end());
    return a;
}

/// The data window begins above and to the left of the display window.
void write(const std::string& path, std::vector<Channels> parts, Imf::Compression compression,
           Imf::LineOrder order) {
    const Imath::Box2i display({0, 0}, {width, height}), data({-2, -3}, {width - 3, height - 4});
    std::vector<Imf::Header> headers;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        Imf::Header h(display, data);
        h.setType(Imf::SCANLINEIMAGE);
        h.setName("part " + std::to_string(i));
        h.compression() = compression;
        h.lineOrder() = order;
        for (const auto& [name, values] : parts[i]) h.channels().insert(name, Imf::Channel(Imf::FLOAT));
        h.insert("cryptomatte/1234567/name", Imf::StringAttribute("CryptoObject"));
        headers.push_back(h);
    }
    Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        Imf::FrameBuffer frame;
        for (auto& [name, values] : parts[i]) {
            auto* first = reinterpret_cast<char*>(values.data() - (data.min.y * width + data.min.x));
            frame.insert(name, Imf::Slice(Imf::FLOAT, first, sizeof(float), sizeof(float) * width));
        }
        Imf::OutputPart out(file, static_cast<int>(i));
        out.setFrameBuffer(frame);
        out.writePixels(height);
    }
}

ForeignPicture read_by(int threads, const std::string& path) {
    Job job({.threads = threads});
    const JobScope scope(job);
    return read_foreign_picture(path, {}, {});
}

void expect_equal(const ForeignPicture& a, const ForeignPicture& b) {
    ASSERT_EQ(a.offsets, b.offsets);
    ASSERT_EQ(a.samples.size(), b.samples.size());
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
        ASSERT_EQ(a.samples[i].r, b.samples[i].r) << i;
        ASSERT_EQ(a.samples[i].id, b.samples[i].id) << i;
    }
    ASSERT_EQ(a.mixed.size(), b.mixed.size());
    for (std::size_t i = 0; i < a.mixed.size(); ++i) ASSERT_EQ(a.mixed[i].pixel, b.mixed[i].pixel) << i;
    ASSERT_EQ(a.shares.size(), b.shares.size());
    for (std::size_t i = 0; i < a.shares.size(); ++i) {
        ASSERT_EQ(a.shares[i].id, b.shares[i].id) << i;
        ASSERT_EQ(a.shares[i].share, b.shares[i].share) << i;
    }
}

TEST(MatteShares, AreEqualInOnePartAndInSeveralWithAnyThreads) {
    const TemporaryFolder folder;
    const auto in = [&](const char* name) { return (folder.path() / name).string(); };
    const Values v = random_values();
    for (const auto compression : {Imf::ZIP_COMPRESSION, Imf::NO_COMPRESSION, Imf::PIZ_COMPRESSION}) {
        for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
            const Channels all = joined(joined(v.colours, v.ranks_0_and_1), v.ranks_2_and_3);
            write(in("one.exr"), {all}, compression, order);
            write(in("two.exr"), {joined(v.colours, v.ranks_0_and_1), v.ranks_2_and_3}, compression, order);
            write(in("apart.exr"), {v.colours, v.ranks_0_and_1, v.ranks_2_and_3}, compression, order);
            write(in("second.exr"), {joined(v.colours, v.ranks_2_and_3), v.ranks_0_and_1}, compression,
                  order);
            const ForeignPicture apart = read_by(1, in("apart.exr"));
            ASSERT_GT(apart.mixed.size(), 1000U);
            for (const int threads : {1, 2}) {
                for (const char* name : {"one.exr", "two.exr", "second.exr", "apart.exr"}) {
                    SCOPED_TRACE(name);
                    expect_equal(read_by(threads, in(name)), apart);
                }
            }
        }
    }
}

/// A damaged chunk is found by a thread of the library.
TEST(MatteShares, OfADamagedFileAreAnErrorWithAnyThreads) {
    const TemporaryFolder folder;
    const std::string path = (folder.path() / "a.exr").string();
    const Values v = random_values();
    write(path, {joined(v.colours, v.ranks_0_and_1)}, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y);
    std::string bytes = bytes_of(path);
    for (std::size_t i = bytes.size() - 400; i < bytes.size() - 300; ++i)
        bytes[i] = static_cast<char>(~bytes[i]);
    write_bytes(path, bytes);
    for (const int threads : {1, 2}) {
        try {
            (void)read_by(threads, path);
            ADD_FAILURE() << "no error with " << threads << " threads";
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::invalid_input);
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace postlens::test::matte_shares_test
