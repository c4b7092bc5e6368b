// --crop: what is written has the bits of the whole picture there, by every method.
#include <OpenImageIO/imageio.h>
#include <fstream>
#include <nlohmann/json.hpp>

#include "records/crop.h"
#include "tests/command_test.h"

namespace postlens::test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

const std::string samples = POSTLENS_SAMPLES;

Words operator+(Words a, const Words& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::string text_of(const Crop& c) {
    return fmt::format("{},{},{},{}", c.x, c.y, c.width, c.height);
}

/// Larger than a block of any method (256 px), and none of its divisors.
constexpr int width = 300, height = 270;
/// Within a block; over several, up to the far corner; a single pixel.
const std::vector<Crop> crops{{70, 90, 41, 23}, {250, 180, 50, 90}, {13, 269, 1, 1}};

class CropCommand : public CommandTest {
  protected:
    json done(const Words& words) {
        const Outcome r = run(words + Words{"--json"});
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return r.exit_code == 0 ? json::parse(r.out) : json();
    }
    std::string traced(const std::string& scene, const Words& more) {
        done(Words{"trace", samples + "/scenes/" + scene, "-o", in("frame.exr"), "--size",
                   fmt::format("{}x{}", width, height), "--subdivide", "1"} +
             more);
        return in("frame.exr");
    }
    /// Writes the whole picture and the crops.
    void expect_bits_of_the_whole(const Words& words, const std::vector<Crop>& parts = crops) {
        std::string all;
        for (const std::string& w : words) all.append(w).append(" ");
        SCOPED_TRACE(all);
        done(words + Words{"-o", in("whole.exr")});
        const Image whole = read_image(in("whole.exr"));
        for (const Crop& crop : parts) {
            const json said = done(words + Words{"-o", in("part.exr"), "--crop", text_of(crop)});
            EXPECT_EQ(said.at("crop").at("width"), crop.width);
            const Image part = read_image(in("part.exr"));
            EXPECT_EQ(part.width, crop.width);
            EXPECT_EQ(part.height, crop.height);
            EXPECT_TRUE(part.rgb == cut(whole, crop).rgb) << text_of(crop);
        }
    }
};

TEST_F(CropCommand, PinholeScatterAndLayersHaveTheBitsOfTheWhole) {
    const std::string frame = traced("still_life.toml", {"--overscan", "8"});
    expect_bits_of_the_whole({"image", frame});
    const Words focus{"focus", frame, "--f-number", "1.4", "--focus", "1"};
    expect_bits_of_the_whole(focus + Words{"--method", "pinhole"});
    expect_bits_of_the_whole(focus);
    expect_bits_of_the_whole(focus + Words{"--impulse", "polygon:6", "--cats-eye", "0.6"});
    expect_bits_of_the_whole(focus + Words{"--method", "layers"});
    // Film distances of other framings magnify the picture.
    expect_bits_of_the_whole(focus + Words{"--breathing"});
}

TEST_F(CropCommand, LightFieldAndHybridHaveTheBitsOfTheWhole) {
    const std::string frame = traced("still_life.toml", {"--overscan", "8"});
    const Words focus{"focus", frame, "--f-number", "1.4", "--focus", "1", "--views", "12"};
    expect_bits_of_the_whole(focus + Words{"--method", "lightfield"});
    expect_bits_of_the_whole(focus + Words{"--method", "hybrid"});
}

TEST_F(CropCommand, WhatIsDecidedOverTheWholePictureStaysSo) {
    const std::string frame = traced("still_life.toml", {"--overscan", "8"});
    const Words focus{"focus", frame, "--f-number", "1.4", "--focus", "1"};
    // Few views: scattering pays where one surface fills most of the picture only.
    expect_bits_of_the_whole(focus + Words{"--method", "hybrid", "--views", "300"}, {crops[0]});
    expect_bits_of_the_whole(focus + Words{"--method", "hybrid", "--views", "12", "--scene",
                                           samples + "/scenes/still_life.toml", "--retrace-spp", "4"},
                             {crops[0]});
    expect_bits_of_the_whole(focus + Words{"--method", "auto", "--target-db", "24"}, {crops[1]});
}

TEST_F(CropCommand, MotionHasTheBitsOfTheWhole) {
    const std::string frame = traced("motion.toml", {"--for-shutter", "0:1", "--keys", "2"});
    for (const char* method : {"convolve", "lightfield", "auto"}) {
        expect_bits_of_the_whole({"motionblur", frame, "--shutter", "0.2:0.7", "--method", method},
                                 {crops[0]});
    }
    expect_bits_of_the_whole(
        {"shoot", frame, "--shutter", "0:1", "--f-number", "2", "--focus", "3", "--views", "12"},
        {crops[0], crops[2]});
}

TEST_F(CropCommand, GapsAreFilledAsInTheWholePicture) {
    // Nothing is recorded of what lies behind: whatever has moved away leaves pixels that no view knows.
    const std::string frame = traced("motion.toml", {});
    expect_bits_of_the_whole(
        {"motionblur", frame, "--shutter", "0.9:1", "--method", "lightfield", "--views", "16"});
    expect_bits_of_the_whole(
        {"shoot", frame, "--shutter", "0.9:1", "--f-number", "22", "--focus", "3", "--views", "8"});
}

TEST_F(CropCommand, RenderTracesOnlyTheTilesOfTheCrop) {
    const Words render{
        "render",  samples + "/scenes/motion.toml", "--size", "60x50", "--spp", "4", "--shutter", "0:1",
        "--halves"};
    expect_bits_of_the_whole(render, {{21, 9, 13, 20}, {59, 49, 1, 1}});
    done(render + Words{"-o", in("whole.exr")});
    const json said = done(render + Words{"-o", in("part.exr"), "--crop", "21,9,13,20"});
    // Tiles of 8 px: columns 2 to 4, rows 1 to 3.
    EXPECT_EQ(said.at("rays").at("eye"), 24 * 24 * 4);
    for (const char* half : {"a", "b"}) {
        const Image whole = read_image(in(fmt::format("whole.{}.exr", half)));
        EXPECT_TRUE(read_image(in(fmt::format("part.{}.exr", half))).rgb ==
                    cut(whole, Crop{21, 9, 13, 20}).rgb);
    }
}

TEST_F(CropCommand, PicturesOfOtherProgramsAreCutAsWell) {
    const std::string deep = std::string(POSTLENS_TEST_DATA) + "/exr/deep_object_ids.exr";
    const json all = done({"image", deep, "-o", in("all.exr")});
    const int w = all.at("width"), h = all.at("height");
    const std::vector<Crop> parts{{w / 3, h / 4, w / 2, h / 3}};
    expect_bits_of_the_whole({"image", deep}, parts);
    for (const char* method : {"scatter", "layers", "pinhole"}) {
        expect_bits_of_the_whole(
            {"focus", deep, "--f-number", "2", "--focus", "300", "--z", "axial", "--method", method}, parts);
    }
    refused({"focus", deep, "-o", in("x.exr"), "--f-number", "2", "--focus", "300", "--crop",
             fmt::format("0,0,{},1", w + 1)},
            ExitCode::wrong_arguments, "--crop");
}

TEST_F(CropCommand, VectorsOfOtherProgramsLikewise) {
    // Two halves that move apart, so that what lies between is known to nobody.
    OIIO::ImageSpec spec(90, 80, 6, OIIO::TypeDesc::FLOAT);
    spec.channelnames = {"R", "G", "B", "Z", "forward.u", "forward.v"};
    std::vector<float> values;
    for (int i = 0; i < 90 * 80; ++i) {
        const auto x = static_cast<float>(i % 90), y = static_cast<float>(i / 90);
        const bool right = x >= 45;
        for (const float v : {x / 90, y / 80, 0.5F, right ? 2.0F : 3.0F, right ? 12.0F : -9.0F, 3.0F})
            values.push_back(v);
    }
    const auto out = OIIO::ImageOutput::create(in("vectors.exr"));
    ASSERT_TRUE(out && out->open(in("vectors.exr"), spec) &&
                out->write_image(OIIO::TypeDesc::FLOAT, values.data()) && out->close());
    expect_bits_of_the_whole({"motionblur", in("vectors.exr"), "--shutter", "0.5:1"},
                             {{40, 20, 30, 30}, {0, 79, 90, 1}});
}

TEST_F(CropCommand, AnOpenExrFileSaysWhereTheCropLies) {
    const std::string frame = traced("motion.toml", {});
    done({"image", frame, "-o", in("part.exr"), "--crop", "20,30,40,50"});
    const auto file = OIIO::ImageInput::open(in("part.exr"));
    ASSERT_TRUE(file);
    const OIIO::ImageSpec& s = file->spec();
    EXPECT_EQ((std::vector{s.x, s.y, s.width, s.height}), (std::vector{20, 30, 40, 50}));
    EXPECT_EQ((std::vector{s.full_x, s.full_y, s.full_width, s.full_height}),
              (std::vector{0, 0, width, height}));
    // Read back it is a picture of its own, and so are those that cannot say where they lie.
    for (const char* name : {"part.exr", "part.png", "part.tif", "part.jpg"}) {
        done({"image", frame, "-o", in(name), "--crop", "20,30,40,50"});
        EXPECT_EQ(read_image_size(in(name)), (ImageSize{40, 50})) << name;
    }
    done({"image", frame, "-o", in("whole.exr")});
    const json said = done({"compare", in("part.png"), in("part.exr")});
    EXPECT_GT(said.at("psnr_db").get<double>(), 50);  // 8 bits: 58.9 dB
    EXPECT_EQ(run({"compare", in("part.exr"), in("whole.exr")}).exit_code,
              static_cast<int>(ExitCode::invalid_input));
}

TEST_F(CropCommand, WhatIsNotWithinThePictureIsRefused) {
    const std::string frame = traced("motion.toml", {});
    for (const char* crop :
         {"0,0,301,10", "0,0,10,271", "300,0,1,1", "0,270,1,1", "-1,0,5,5", "0,-1,5,5", "0,0,0,5", "0,0,5,-5",
          "1,2,3", "1,2,3,4,5", "", "a,b,c,d", "1.5,0,5,5", "1,,2,3", "299,0,2147483647,1",
          "2147483647,0,2147483647,1", "99999999999,0,1,1", "nan,0,1,1"}) {
        refused({"image", frame, "-o", in("x.exr"), std::string("--crop=") + crop}, ExitCode::wrong_arguments,
                "--crop: not ");
    }
    for (const Words& command :
         {Words{"focus", frame, "--f-number", "2", "--focus", "2"},
          Words{"focus", frame, "--f-number", "2", "--focus", "2", "--method", "auto"},
          Words{"motionblur", frame, "--shutter", "0:1"},
          Words{"shoot", frame, "--shutter", "0:1", "--f-number", "2", "--focus", "2"},
          Words{"render", samples + "/scenes/motion.toml", "--size", "300x270", "--spp", "1"}}) {
        for (const char* crop : {"200,0,101,10", "1,2,3"})
            refused(command + Words{"-o", in("x.exr"), "--crop", crop}, ExitCode::wrong_arguments,
                    "--crop: not ");
    }
}

}  // namespace
}  // namespace postlens::test
