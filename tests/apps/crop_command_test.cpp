// --crop: for every method, the pixels of a crop are bit-identical to those of the whole image.
#include <OpenEXR/ImfInputFile.h>
#include <nlohmann/json.hpp>

#include "pictures/crop.h"
#include "tests/support/command_test.h"
#include "tests/support/flat_exr.h"

namespace postlens::test::crop_command_test {
namespace {

using nlohmann::json;

const std::string samples = POSTLENS_SAMPLES;

std::string text_of(const Crop& c) {
    return fmt::format("{},{},{},{}", c.x, c.y, c.width, c.height);
}

constexpr int width = 120, height = 80;
const std::vector<Crop> crops{{50, 30, 41, 23}};

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
    /// Writes the whole image and the crops, and compares their bits.
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

TEST_F(CropCommand, EveryCommandWritesTheBitsOfTheWhole) {
    const std::string frame = traced("motion.toml", {"--for-shutter", "0:1"});
    expect_bits_of_the_whole({"image", frame});
    expect_bits_of_the_whole({"focus", frame, "--f-number", "1.4", "--focus", "3"});
    expect_bits_of_the_whole({"motionblur", frame, "--shutter", "0.2:0.4"});
    expect_bits_of_the_whole(
        {"shoot", frame, "--shutter", "0:1", "--f-number", "2", "--focus", "3", "--views", "4"});
    expect_bits_of_the_whole({"render", samples + "/scenes/motion.toml", "--size", "60x50", "--spp", "1"},
                             {{21, 9, 13, 20}});
}

TEST_F(CropCommand, PicturesOfOtherProgramsAreCutAsWell) {
    const std::string deep = POSTLENS_TEST_DATA "/exr/deep_object_ids.exr";
    const json all = done({"image", deep, "-o", in("all.exr")});
    const int w = all.at("width"), h = all.at("height");
    const std::vector<Crop> parts{{w / 3, h / 4, w / 2, h / 3}};
    expect_bits_of_the_whole({"image", deep}, parts);
    for (const char* method : {"scatter", "layers"}) {
        expect_bits_of_the_whole(
            {"focus", deep, "--f-number", "2", "--focus", "300", "--z", "axial", "--method", method}, parts);
    }
    refused({"focus", deep, "-o", in("x.exr"), "--f-number", "2", "--focus", "300", "--crop",
             fmt::format("0,0,{},1", w + 1)},
            ExitCode::wrong_arguments, "--crop");
}

TEST_F(CropCommand, VectorsOfOtherProgramsLikewise) {
    // Two halves that move apart and leave a hole between them.
    write_flat_exr(
        in("vectors.exr"), {"R", "G", "B", "Z", "forward.u", "forward.v"}, 90, 80, [](int x, int y) {
            const bool right = x >= 45;
            return std::vector<float>{static_cast<float>(x) / 90, static_cast<float>(y) / 80, 0.5F,
                                      right ? 2.0F : 3.0F,        right ? 12.0F : -9.0F,      3.0F};
        });
    expect_bits_of_the_whole({"motionblur", in("vectors.exr"), "--shutter", "0.5:1"},
                             {{40, 20, 30, 30}, {0, 79, 90, 1}});
}

TEST_F(CropCommand, AnOpenExrFileSaysWhereTheCropLies) {
    const std::string frame = traced("motion.toml", {});
    done({"image", frame, "-o", in("part.exr"), "--crop", "20,30,40,50"});
    const Imf::InputFile file(in("part.exr").c_str());
    EXPECT_EQ(file.header().dataWindow(), (Window{20, 30, 40, 50}.box()));
    EXPECT_EQ(file.header().displayWindow(), (Window{0, 0, width, height}.box()));
    // A crop that is read is an image of the crop's size, also for formats that cannot store its position.
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
    for (const char* crop : {"0,0,121,10", "0,80,1,1", "-1,0,5,5", "0,0,0,5", "1,2,3", "", "1.5,0,5,5",
                             "99,0,2147483647,1", "99999999999,0,1,1"}) {
        refused({"image", frame, "-o", in("x.exr"), "--crop", crop}, ExitCode::wrong_arguments, "--crop: ");
    }
    const Words lens{"--f-number", "2", "--focus", "2"}, shutter{"--shutter", "0:1"};
    for (const Words& command :
         {Words{"focus", frame} + lens, Words{"focus", frame, "--method", "auto"} + lens,
          Words{"motionblur", frame} + shutter, Words{"shoot", frame} + lens + shutter,
          Words{"render", samples + "/scenes/motion.toml", "--size", "120x80", "--spp", "1"}}) {
        refused(command + Words{"-o", in("x.exr"), "--crop", "20,0,101,10"}, ExitCode::wrong_arguments,
                "--crop: not within the picture (got 20,0,101,10; expected X,Y,W,H within 120x80 px");
    }
}

}  // namespace
}  // namespace postlens::test::crop_command_test
