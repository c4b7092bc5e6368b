#include "pictures/encoded_picture.h"

#include <bit>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>

#include "core/checksum.h"
#include "core/error.h"
#include "pictures/exr/flat_exr.h"
#include "pictures/srgb.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::encoded_picture_test {
namespace {

int by_power(float v) {
    return static_cast<int>(std::lround(srgb_from_linear(v) * 255.0F));
}

TEST(EncodedPicture, BytesAreThoseOfTheCurve) {
    for (const float v :
         {0.0F, -0.0F, -1.0F, 1.0F, 2.0F, 1e30F, 1e-30F, std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
        EXPECT_EQ(srgb_byte(v), by_power(v)) << v;
    // Tests every 97th float from 2^-14 to 1, and the two floats on either side of each byte's lower limit.
    const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v); };
    for (std::uint32_t b = bits(0x1p-14F); b < bits(1.0F); b += 97) {
        const auto v = std::bit_cast<float>(b);
        ASSERT_EQ(srgb_byte(v), by_power(v)) << v;
    }
    for (int byte = 1; byte < 256; ++byte) {
        std::uint32_t below = bits(0x1p-14F), from = bits(1.0F);
        while (from - below > 1) {
            const std::uint32_t middle = below + (from - below) / 2;
            (by_power(std::bit_cast<float>(middle)) < byte ? below : from) = middle;
        }
        EXPECT_EQ(srgb_byte(std::bit_cast<float>(below)), byte - 1);
        EXPECT_EQ(srgb_byte(std::bit_cast<float>(from)), byte);
    }
}

TEST(EncodedPicture, IsWrittenAsThePictureItWasMadeOf) {
    const TemporaryFolder folder;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> value(-0.1F, 1.2F);
    // Noise, which deflate cannot compress, in sizes that are not multiples of a block.
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 513}, {513, 1}, {301, 203}}) {
        Image image(width, height);
        for (float& v : image.rgb) v = value(random);
        write_image(folder.path() / "a.png", image);
        EXPECT_EQ(bytes_of(folder.path() / "a.png"), png_file(encoded_8bit(image), "b.png"));
        const Image back = read_image(folder.path() / "a.png");
        ASSERT_EQ(back.rgb.size(), image.rgb.size());
        for (std::size_t i = 0; i < image.rgb.size(); ++i)
            ASSERT_EQ(by_power(back.rgb[i]), by_power(image.rgb[i])) << i;
    }
}

std::uint64_t checksum_of(const std::filesystem::path& path) {
    const std::string bytes = bytes_of(path);
    return postlens::checksum_of(bytes.data(), bytes.size());
}

TEST(WriteImage, ReturnsTheChecksumOfTheFile) {
    const TemporaryFolder folder;
    Image image(317, 113);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = static_cast<float>(i % 97) / 96;
    for (const char* name : {"a.exr", "a.png", "a.tif", "a.jpg"}) {
        const std::uint64_t whole = write_image(folder.path() / name, image);
        EXPECT_EQ(whole, checksum_of(folder.path() / name)) << name;
        const std::uint64_t part = write_image(folder.path() / name, image, Crop{7, 9, 100, 50});
        EXPECT_EQ(part, checksum_of(folder.path() / name)) << name;
    }
    image.alpha.assign(image.rgb.size() / 3, 0.5F);
    const std::uint64_t with_alpha = write_image(folder.path() / "a.exr", image);
    EXPECT_EQ(with_alpha, checksum_of(folder.path() / "a.exr"));
}

TEST(WriteFlatExr, KnowsItsChecksumWhereItIsWrittenInOrder) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.exr";
    std::ofstream(path) << "";
    const std::vector<float> values(40 * 33, 0.25F);
    FlatExr exr;
    exr.display = exr.data = {0, 0, 39, 32};
    exr.channels = {{"Y", ExrChannel::Type::float32, values.data()}};
    exr.pixel_bytes = sizeof(float);
    exr.row_bytes = 40 * sizeof(float);
    // A header that is larger than the amount written at once.
    exr.texts = {{"long", std::string(400'000, 'x')}};
    exr.compression = ChunkCompression::none;
    const std::optional<std::uint64_t> checksum = write_flat_exr(path, "a.exr", exr);
    EXPECT_EQ(checksum, checksum_of(path));
    EXPECT_EQ(read_image(path).rgb[300], 0.25F);
    for (const ChunkCompression packed :
         {ChunkCompression::zips, ChunkCompression::zip, ChunkCompression::rle}) {
        exr.compression = packed;
        EXPECT_FALSE(write_flat_exr(path, "a.exr", exr).has_value());
        EXPECT_EQ(read_image(path).rgb[3 * (40 * 33 - 1)], 0.25F);
    }
}

TEST(EncodedPicture, SaysWhatIsWrongWithItsSize) {
    try {
        (void)png_file(EncodedPicture(0, 4), "a.png");
        FAIL() << "a picture of no pixels";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::cannot_write);
        const std::string said = e.what();
        EXPECT_EQ(said.find("a.png: cannot write ("), 0U) << said;
        EXPECT_NE(said.find("IHDR"), std::string::npos) << said;
    }
}

}  // namespace
}  // namespace postlens::test::encoded_picture_test
