#include "pictures/image.h"

#include <Imath/half.h>
#include <OpenImageIO/imageio.h>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <sys/resource.h>
#include <thread>
#include <vector>

#include "core/error.h"
#include "pictures/crop.h"
#include "pictures/formats/picture_library.h"
#include "pictures/formats/plain_picture.h"
#include "pictures/srgb.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::image_test {
namespace {

namespace fs = std::filesystem;

Image ramp(int width, int height) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            float* p = image.pixel(x, y);
            p[0] = static_cast<float>(x) / static_cast<float>(width - 1);
            p[1] = static_cast<float>(y) / static_cast<float>(height - 1);
            p[2] = 0.3F;
        }
    }
    return image;
}

/// The exit code and the message of the Error that `body` throws.
template <typename Body>
std::pair<ExitCode, std::string> error_of(const Body& body) {
    try {
        body();
    } catch (const Error& e) {
        return {e.code(), e.what()};
    }
    return {ExitCode::ok, ""};
}

TEST(Image, ExrKeepsEveryBit) {
    const TemporaryFolder folder;
    Image image = ramp(37, 11);
    image.pixel(3, 4)[0] = -1.5F;
    image.pixel(5, 4)[1] = 60000.25F;
    image.pixel(6, 4)[2] = 1e-30F;
    write_image(folder.path() / "a.exr", image);
    const Image back = read_image(folder.path() / "a.exr");
    EXPECT_EQ(back.width, 37);
    EXPECT_EQ(back.height, 11);
    EXPECT_EQ(back.rgb, image.rgb);
    EXPECT_EQ(folder.file_count(), 1U);
}

TEST(Image, ExrHasAnOpaqueAlpha) {
    const TemporaryFolder folder;
    write_image(folder.path() / "a.exr", ramp(4, 4));
    const auto in = OIIO::ImageInput::open((folder.path() / "a.exr").string());
    ASSERT_TRUE(in);
    EXPECT_EQ(in->spec().nchannels, 4);
    EXPECT_EQ(in->spec().alpha_channel, 3);
    std::vector<float> rgba(4 * 4 * 4);
    ASSERT_TRUE(in->read_image(0, 0, 0, 4, OIIO::TypeDesc::FLOAT, rgba.data()));
    for (std::size_t i = 3; i < rgba.size(); i += 4) EXPECT_EQ(rgba[i], 1.0F);
}

double encode_srgb(double v) {
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

/// Largest difference of encoded values, after the transfer curve; integer formats round these.
double encoded_error(const Image& a, const Image& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i) {
        const double x = std::clamp(static_cast<double>(a.rgb[i]), 0.0, 1.0);
        worst = std::max(worst, std::abs(encode_srgb(x) - encode_srgb(static_cast<double>(b.rgb[i]))));
    }
    return worst;
}

TEST(Image, IntegerFormatsUseTheSrgbCurveAndRoundToTheNearestStep) {
    const TemporaryFolder folder;
    const Image image = ramp(64, 64);
    const auto round_trip = [&](const char* name) {
        write_image(folder.path() / name, image);
        return encoded_error(image, read_image(folder.path() / name));
    };
    EXPECT_LE(round_trip("a.png"), 0.5 / 255 + 1e-6);
    EXPECT_LE(round_trip("a.tif"), 0.5 / 65535 + 1e-6);
    EXPECT_LE(round_trip("a.PNG"), 0.5 / 255 + 1e-6);
    EXPECT_LE(round_trip("a.jpg"), 0.1);  // lossy: quality 95, colour at half resolution
}

TEST(Image, PngHoldsTheExpectedBytes) {
    const TemporaryFolder folder;
    Image image(5, 1);
    const std::array<float, 5> values{0.0F, 0.5F, 1.0F, 7.0F, -3.0F};
    for (int x = 0; x < 5; ++x) image.pixel(x, 0)[0] = values[static_cast<std::size_t>(x)];
    image.pixel(0, 0)[1] = std::numeric_limits<float>::quiet_NaN();
    write_image(folder.path() / "a.png", image);
    const auto in = OIIO::ImageInput::open((folder.path() / "a.png").string());
    ASSERT_TRUE(in);
    std::array<std::uint8_t, 15> bytes{};
    ASSERT_TRUE(in->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()));
    EXPECT_EQ(bytes[0], 0);
    EXPECT_EQ(bytes[1], 0);    // NaN
    EXPECT_EQ(bytes[3], 188);  // 0.5 linear
    EXPECT_EQ(bytes[6], 255);
    EXPECT_EQ(bytes[9], 255);
    EXPECT_EQ(bytes[12], 0);
}

TEST(Image, GreyBecomesRgb) {
    const TemporaryFolder folder;
    const std::string name = (folder.path() / "grey.exr").string();
    const auto out = OIIO::ImageOutput::create(name);
    ASSERT_TRUE(out);
    const std::array<float, 3> grey{0.25F, 2.0F, -1.0F};
    ASSERT_TRUE(out->open(name, OIIO::ImageSpec(3, 1, 1, OIIO::TypeDesc::FLOAT)));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, grey.data()) && out->close());
    const Image image = read_image(name);
    EXPECT_EQ(image.rgb, (std::vector<float>{0.25F, 0.25F, 0.25F, 2, 2, 2, -1, -1, -1}));
}

TEST(Image, UnknownEndingsAreWrongArguments) {
    const TemporaryFolder folder;
    for (const char* name : {"a.bmp", "a", "a.exr.gz"}) {
        EXPECT_EQ(error_of([&] { check_image_path(folder.path() / name); }).first, ExitCode::wrong_arguments);
        EXPECT_EQ(error_of([&] { write_image(folder.path() / name, Image(2, 2)); }).first,
                  ExitCode::wrong_arguments);
    }
    EXPECT_EQ(folder.file_count(), 0U);
}

TEST(Image, WritingWhereNothingCanBeWrittenSaysSo) {
    const TemporaryFolder folder;
    fs::create_directory(folder.path() / "folder.exr");
    for (const fs::path& path : {folder.path() / "missing" / "a.exr", folder.path() / "folder.exr",
                                 fs::path("/proc/postlens_cannot_write.exr")}) {
        const auto [code, text] = error_of([&] { write_image(path, Image(2, 2)); });
        EXPECT_EQ(code, ExitCode::cannot_write);
        EXPECT_EQ(text.rfind(path.string(), 0), 0U) << text;
        EXPECT_EQ(text.find('\n'), std::string::npos);
    }
}

TEST(Image, AFullDiskIsAnErrorAndLeavesNothing) {
    const TemporaryFolder folder;
    Image noise(200, 200);
    std::uint32_t state = 1;
    for (float& v : noise.rgb) v = static_cast<float>(state = state * 1664525U + 1013904223U) / 4e9F;
    for (const char* name : {"a.exr", "a.png", "a.tif", "a.jpg"}) {
        const auto [code, text] = error_of([&] {
            const FileSizeLimit limit(4096);
            write_image(folder.path() / name, noise);
        });
        EXPECT_EQ(code, ExitCode::cannot_write) << name;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
    EXPECT_EQ(folder.file_count(), 0U);
}

TEST(Image, ALargerJpegThanItsFormatHoldsIsAnError) {
    const TemporaryFolder folder;
    const Image wide(65501, 1);
    const auto [code, text] = error_of([&] { write_image(folder.path() / "wide.jpg", wide); });
    EXPECT_EQ(code, ExitCode::cannot_write);
    EXPECT_NE(text.find("wide.jpg: too large for JPEG (got 65501x1 px"), std::string::npos) << text;
    EXPECT_EQ(folder.file_count(), 0U);
    write_image(folder.path() / "part.jpg", wide, Crop{1, 0, 65500, 1});
    EXPECT_EQ(folder.file_count(), 1U);
}

// Equal images must give equal files, so files must not contain the time of writing (whole seconds).
TEST(Image, EqualPicturesAreEqualFiles) {
    const TemporaryFolder folder;
    const auto bytes = [&](const std::string& name) {
        write_image(folder.path() / name, ramp(8, 6));
        return bytes_of(folder.path() / name);
    };
    std::vector<std::string> before;
    const std::vector<std::string> names{"a.exr", "a.png", "a.jpg", "a.tif"};
    before.reserve(names.size());
    for (const std::string& name : names) before.push_back(bytes(name));
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(bytes(names[i]), before[i]) << names[i];
}

TEST(Image, UnreadableFilesAreInvalidInput) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "text.exr") << "not a picture";
    std::ofstream(folder.path() / "empty.png");
    for (const char* name : {"text.exr", "empty.png", "missing.exr", "."}) {
        const auto [code, text] = error_of([&] { (void)read_image(folder.path() / name); });
        EXPECT_EQ(code, ExitCode::invalid_input) << name;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
}

/// Writes a file with OpenImageIO.
void write_by_oiio(const fs::path& path, const OIIO::ImageSpec& spec, const void* values) {
    const auto out = OIIO::ImageOutput::create(path.string());
    ASSERT_TRUE(out);
    ASSERT_TRUE(out->open(path.string(), spec)) << out->geterror();
    ASSERT_TRUE(out->write_image(spec.format, values) && out->close());
}

/// Checks that the reader without OpenImageIO gives the same header and bits of pixels as OpenImageIO.
void expect_equal_readers(const fs::path& path) {
    SCOPED_TRACE(path.filename().string());
    const auto plain = open_plain_picture(path);
    ASSERT_TRUE(plain);
    std::string problem;
    const auto other = picture_library().open(path.string(), problem);
    ASSERT_TRUE(other) << problem;
    const PictureLayout &a = plain->layout(), &b = other->layout();
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_EQ(a.x, b.x);
    EXPECT_EQ(a.y, b.y);
    EXPECT_EQ(a.full_x, b.full_x);
    EXPECT_EQ(a.full_y, b.full_y);
    EXPECT_EQ(a.full_width, b.full_width);
    EXPECT_EQ(a.full_height, b.full_height);
    EXPECT_EQ(a.channels, b.channels);
    EXPECT_EQ(a.format, b.format);
    EXPECT_EQ(a.colour_space == "sRGB", !b.floating_point);
    EXPECT_EQ(a.crop, b.crop);
    EXPECT_EQ(a.deep, b.deep);
    EXPECT_EQ(a.floating_point, b.floating_point);
    const int channels = a.channels.size() >= 3 ? 3 : 1;
    const std::size_t count = static_cast<std::size_t>(a.width) * static_cast<std::size_t>(a.height) *
                              static_cast<std::size_t>(channels);
    std::vector<float> of_plain(count), of_other(count);
    EXPECT_EQ(plain->read(channels, of_plain.data()), "");
    EXPECT_EQ(other->read(channels, of_other.data()), "");
    EXPECT_EQ(of_plain, of_other);
}

TEST(PlainPicture, ReadsWhatOpenImageIoReads) {
    const TemporaryFolder folder;
    const fs::path at = folder.path();
    Image every_byte(16, 16);
    for (std::size_t i = 0; i < every_byte.rgb.size(); ++i)
        every_byte.rgb[i] = linear_from_srgb(static_cast<float>(i % 256) / 255);
    write_image(at / "own.png", every_byte);
    write_image(at / "own.exr", ramp(37, 11));
    write_image(at / "crop.exr", ramp(37, 11), Crop{5, 3, 20, 6});
    std::vector<float> values(3 * 7 * 4);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i) * 0.37F - 3;
    for (const char* compression : {"none", "zip", "piz", "dwaa"}) {
        OIIO::ImageSpec spec(7, 3, 4, OIIO::TypeDesc::HALF);
        spec["compression"] = compression;
        std::vector<Imath::half> halves(values.begin(), values.end());
        write_by_oiio(at / (std::string(compression) + ".exr"), spec, halves.data());
    }
    OIIO::ImageSpec shifted(7, 3, 3, OIIO::TypeDesc::FLOAT);
    shifted.x = -2;
    shifted.y = 9;
    shifted.full_x = -5;
    shifted.full_y = 1;
    shifted.full_width = 20;
    shifted.full_height = 30;
    write_by_oiio(at / "window.exr", shifted, values.data());
    OIIO::ImageSpec tiled(7, 3, 4, OIIO::TypeDesc::FLOAT);
    tiled.tile_width = tiled.tile_height = 16;
    {
        const auto out = OIIO::ImageOutput::create((at / "tiled.exr").string());
        ASSERT_TRUE(out && out->open((at / "tiled.exr").string(), tiled));
        ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, values.data()) && out->close());
    }
    write_by_oiio(at / "grey.exr", OIIO::ImageSpec(7, 3, 1, OIIO::TypeDesc::FLOAT), values.data());
    std::vector<std::uint8_t> bytes(3 * 7 * 3);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(41 * i);
    write_by_oiio(at / "grey.png", OIIO::ImageSpec(7, 3, 1, OIIO::TypeDesc::UINT8), bytes.data());
    OIIO::ImageSpec described(7, 3, 3, OIIO::TypeDesc::UINT8);
    described["ImageDescription"] = "seven by three";
    described["XResolution"] = 72.0F;
    described["YResolution"] = 72.0F;
    write_by_oiio(at / "described.png", described, bytes.data());
    for (const fs::directory_entry& entry : fs::directory_iterator(at)) {
        expect_equal_readers(entry.path());
    }
    expect_equal_readers(fs::path(POSTLENS_SAMPLES) / "scenes/textures/label.png");
}

TEST(PlainPicture, LeavesTheRestToOpenImageIo) {
    const TemporaryFolder folder;
    const fs::path at = folder.path();
    const std::vector<std::uint16_t> values(4 * 7 * 3, 30000);
    write_by_oiio(at / "alpha.png", OIIO::ImageSpec(7, 3, 4, OIIO::TypeDesc::UINT8), values.data());
    write_by_oiio(at / "deep_colour.png", OIIO::ImageSpec(7, 3, 3, OIIO::TypeDesc::UINT16), values.data());
    OIIO::ImageSpec linear(7, 3, 3, OIIO::TypeDesc::UINT8);
    linear["oiio:ColorSpace"] = "Linear";
    linear["oiio:Gamma"] = 1.0F;
    write_by_oiio(at / "linear.png", linear, values.data());
    write_by_oiio(at / "picture.tif", OIIO::ImageSpec(7, 3, 3, OIIO::TypeDesc::UINT8), values.data());
    OIIO::ImageSpec named(7, 3, 3, OIIO::TypeDesc::HALF);
    named.channelnames = {"red", "green", "blue"};
    write_by_oiio(at / "named.exr", named, values.data());
    std::ofstream(at / "short.png") << "\x89PN";
    std::ofstream(at / "cut.png") << "\x89PNG\r\n\x1A\n";
    for (const fs::directory_entry& entry : fs::directory_iterator(at))
        EXPECT_FALSE(open_plain_picture(entry.path())) << entry.path();
}

TEST(PlainPicture, ADamagedFileIsAnErrorOrAPictureButNothingElse) {
    const TemporaryFolder folder;
    const fs::path at = folder.path();
    write_image(at / "a.png", ramp(19, 7));
    write_image(at / "a.exr", ramp(19, 7));
    for (const char* name : {"a.png", "a.exr"}) {
        const std::string whole = bytes_of(at / name);
        ASSERT_GT(whole.size(), 100U);
        const fs::path broken = at / (std::string("broken_") + name);
        for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 97) {
            std::ofstream(broken, std::ios::binary) << whole.substr(0, size);
            const auto [code, text] = error_of([&] { (void)read_image(broken); });
            // A PNG file without its last 12 bytes is complete: they only mark the end.
            if (size + 12 < whole.size()) {
                EXPECT_EQ(code, ExitCode::invalid_input) << name << " cut at " << size;
            }
            EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        }
        for (std::size_t k = 0; k < whole.size(); k += 1 + whole.size() / 197) {
            std::string bytes = whole;
            bytes[k] = static_cast<char>(bytes[k] ^ 0x55);
            std::ofstream(broken, std::ios::binary) << bytes;
            const auto [code, text] = error_of([&] { (void)read_image(broken); });
            EXPECT_TRUE(code == ExitCode::ok || code == ExitCode::invalid_input) << name << " at " << k;
            EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        }
    }
}

}  // namespace
}  // namespace postlens::test::image_test
