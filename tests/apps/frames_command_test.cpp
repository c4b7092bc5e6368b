// --frames: one command processes all frames of a range.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pictures/image.h"
#include "records/sample_file.h"
#include "tests/support/command_test.h"

namespace postlens::test::frames_command_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Frames : public CommandTest {
  protected:
    // A ball that crosses the frame in two seconds.
    std::string scene() {
        std::string path = in("scene.toml");
        std::ofstream(path) << "[[camera]]\n"
                               "focal_length_mm = 50\n"
                               "width_px = 48\n"
                               "height_px = 32\n"
                               "f_number = 2\n"
                               "focus_m = 3\n"
                               "\n"
                               "[[light]]\n"
                               "kind = \"point\"\n"
                               "position_m = [2, 3, 1]\n"
                               "\n"
                               "[[object]]\n"
                               "shape = \"sphere\"\n"
                               "radius_m = 0.4\n"
                               "keys = [{ time_s = 0, translate_m = [-0.5, 0, -3] }, "
                               "{ time_s = 2, translate_m = [0.5, 0.2, -4] }]\n"
                               "\n"
                               "[[object]]\n"
                               "shape = \"plane\"\n"
                               "normal = [0, 1, 0]\n"
                               "point_m = [0, -0.5, 0]\n";
        return path;
    }
    json done(const Words& words) {
        const Outcome r = run(words + Words{"--json"});
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return r.exit_code == 0 ? json::parse(r.out) : json();
    }
    /// The same pixels; of sample files, the same records. A frame's file also says how it was made.
    void expect_same_content(const std::string& a, const std::string& b) {
        const Image one = read_image(in(a)), other = read_image(in(b));
        EXPECT_TRUE(one.rgb == other.rgb && one.exposure_stops == other.exposure_stops) << a << ", " << b;
        if (!SampleFileReader::is_sample_file(in(a))) return;
        const SampleFileReader first(in(a)), second(in(b));
        ASSERT_EQ(first.instants(), second.instants());
        for (std::size_t i = 0; i < first.instants(); ++i) {
            RecordBand left, right;
            first.read(first.y_begin(), first.y_end(), left, i);
            second.read(second.y_begin(), second.y_end(), right, i);
            EXPECT_TRUE(left.records == right.records && left.offsets == right.offsets) << a << ", " << b;
        }
    }
    /// What --keep says of each frame: empty for one that was kept, else why it was made again.
    Words made_again(const Words& words) {
        Words out;
        const json said = done(words + Words{"--keep"});
        for (const json& frame : said.at("frames"))
            out.push_back(frame.value("made_again", frame.at("kept") ? "" : "absent"));
        return out;
    }
    json trace_three(const Words& more = {}) {
        return done(Words{"trace", scene(), "-o", in("f.%04d.exr"), "--frames", "0-2", "--fps", "2"} + more);
    }
};

TEST_F(Frames, TraceTakesEachFrameAtItsTime) {
    const json said = trace_three({"--for-shutter", "0:0.25"});
    ASSERT_EQ(said.at("frames").size(), 3U);
    for (int n = 0; n < 3; ++n) {
        const json& frame = said.at("frames").at(static_cast<std::size_t>(n));
        EXPECT_EQ(frame.at("frame"), n);
        EXPECT_EQ(frame.at("output"), in(fmt::format("f.000{}.exr", n)));
        EXPECT_EQ(frame.at("time_s"), n / 2.0);
        EXPECT_GT(frame.at("records"), 0);
        // The shutter of --for-shutter opens at the frame's instant.
        const std::string t = fmt::format("{}", n / 2.0), close = fmt::format("{}", n / 2.0 + 0.25);
        done({"trace", scene(), "-o", in("one.exr"), "--time", t, "--for-shutter", t + ":" + close});
        expect_same_content("one.exr", fmt::format("f.000{}.exr", n));
    }
    done({"trace", scene(), "-o", in("late.#.exr"), "--frames", "12", "--time", "0.25"});
    EXPECT_EQ(SampleFileReader(in("late.12.exr")).header().time_s, 0.75);  // 24 frames/s
}

TEST_F(Frames, PicturesAreThoseOfTheFramesAlone) {
    trace_three({"--for-shutter", "0:0.5", "--overscan", "4"});
    const Words of_all{"--frames", "0-2x2"};
    const std::string frames = in("f.%04d.exr");
    done(Words{"image", frames, "-o", in("image.%d.png")} + of_all);
    done(Words{"focus", frames, "-o", in("focus.%d.exr"), "--f-number", "1.4", "--focus", "2"} + of_all);
    done(Words{"motionblur", frames, "-o", in("motion.##.exr"), "--shutter", "0:0.25"} + of_all);
    done(Words{"shoot", in("f.####.exr"), "-o", in("both.%02d.exr"), "--shutter", "-0.125:0.25", "--views",
               "8", "--f-number", "2", "--focus", "3", "--explain", in("why.%d.png")} +
         of_all);
    done(
        Words{"render", scene(), "-o", in("rays.%d.exr"), "--spp", "4", "--shutter", "0:0.25", "--fps", "2"} +
        of_all);
    EXPECT_FALSE(fs::exists(in("image.1.png")));
    const std::string last = in("f.0002.exr");  // at 1 s
    done({"image", last, "-o", in("image.png")});
    done({"focus", last, "-o", in("focus.exr"), "--f-number", "1.4", "--focus", "2"});
    done({"motionblur", last, "-o", in("motion.exr"), "--shutter", "1:1.25"});
    done({"shoot", last, "-o", in("both.exr"), "--shutter", "0.875:1.25", "--views", "8", "--f-number", "2",
          "--focus", "3", "--explain", in("why.png")});
    done({"render", scene(), "-o", in("rays.exr"), "--spp", "4", "--shutter", "1:1.25"});
    expect_same_content("image.2.png", "image.png");
    expect_same_content("focus.2.exr", "focus.exr");
    expect_same_content("motion.02.exr", "motion.exr");
    expect_same_content("both.02.exr", "both.exr");
    expect_same_content("why.2.png", "why.png");
    expect_same_content("rays.2.exr", "rays.exr");
}

TEST_F(Frames, AnInterruptedRangeGoesOn) {
    trace_three();
    const Words again{"trace", scene(), "-o", in("f.%04d.exr"), "--frames", "0-3", "--fps", "2"};
    const std::string whole = bytes_of(in("f.0001.exr"));
    // One file was truncated while it was copied; another lacks only its last byte.
    std::ofstream(in("f.0001.exr"), std::ios::binary) << whole.substr(0, whole.size() / 2);
    fs::resize_file(in("f.0002.exr"), fs::file_size(in("f.0002.exr")) - 1);
    const json said = done(again + Words{"--keep"});
    EXPECT_EQ(said.at("kept"), 1);
    std::vector<bool> kept;
    for (const json& frame : said.at("frames")) kept.push_back(frame.at("kept"));
    EXPECT_EQ(kept, (std::vector{true, false, false, false}));
    EXPECT_TRUE(bytes_of(in("f.0001.exr")) == whole);

    const Words images{"image", in("f.%04d.exr"), "-o", in("p.%d.png"), "--frames", "0-3"};
    done(images);
    fs::resize_file(in("p.2.png"), fs::file_size(in("p.2.png")) / 2);
    EXPECT_EQ(done(images + Words{"--keep"}).at("kept"), 3);
    EXPECT_EQ(done(images + Words{"--keep"}).at("kept"), 4);
    EXPECT_EQ(done(images).at("kept"), 0);  // made again
}

TEST_F(Frames, KeptFramesAreThoseOfTheSameSettingsAndInputs) {
    trace_three();
    const Words trace{"trace", scene(), "-o", in("f.%04d.exr"), "--frames", "0-2", "--fps", "2"};
    EXPECT_EQ(made_again(trace), (Words{"", "", ""}));
    EXPECT_EQ(made_again(trace + Words{"--threads", "1"}), (Words{"", "", ""}));
    EXPECT_EQ(made_again(trace + Words{"--subdivide", "1"})[2],
              R"(--subdivide (got nothing; expected ["1"]))");
    const std::string why = made_again(trace)[0];
    EXPECT_NE(why.find("--subdivide"), std::string::npos) << why;
    // Each format holds what is asked for.
    for (const std::string ending : {"exr", "png", "tif", "jpg"}) {
        const Words focus{"focus", in("f.%04d.exr"), "-o", in("p.%d." + ending), "--frames",
                          "0-2",   "--focus",        "3"};
        EXPECT_EQ(made_again(focus + Words{"--f-number", "2"}), (Words{"absent", "absent", "absent"}))
            << ending;
        const Words others = made_again(focus + Words{"--f-number", "4"});
        EXPECT_EQ(others[1], R"(--f-number (got ["2"]; expected ["4"]))") << ending;
        if (ending != "exr") continue;
        EXPECT_EQ(made_again(focus + Words{"--f-number", "4"}), (Words{"", "", ""}));
        EXPECT_EQ(made_again(focus + Words{"--f-number", "4", "--share", "1/2"}), (Words{""}));
    }
    // Another input of one frame.
    const Words image{"image", in("f.%04d.exr"), "-o", in("i.%d.png"), "--frames", "0-2"};
    done(image);
    fs::copy_file(in("f.0000.exr"), in("f.0001.exr"), fs::copy_options::overwrite_existing);
    const Words changed = made_again(image);
    EXPECT_EQ(changed[0], "");
    EXPECT_EQ(changed[1].rfind("FRAME (got [\"sha256:", 0), 0U) << changed[1];
    // A file that a scene refers to is its input as well, and a file that says nothing is made again.
    std::ofstream(in("t.ppm")) << "P3 1 1 255 255 0 0\n";
    const std::string textured = in("textured.toml");
    std::ofstream(textured) << bytes_of(scene())
                            << "[[texture]]\nname = \"t\"\nkind = \"image\"\nfile = \"t.ppm\"\n";
    const Words rays{"render", textured, "-o", in("r.%d.exr"), "--frames", "0", "--spp", "1"};
    done({"render", textured, "-o", in("r.0.exr"), "--spp", "1"});
    EXPECT_EQ(made_again(rays), (Words{"its file does not say how"}));
    EXPECT_EQ(made_again(rays), (Words{""}));
    std::ofstream(in("t.ppm")) << "P3 1 1 255 0 255 0\n";
    EXPECT_EQ(made_again(rays)[0].rfind("SCENE (got", 0), 0U);
    // So are the halves of a render, each by itself.
    const Words halves{"render", scene(), "-o", in("h.%d.exr"), "--frames", "0", "--spp", "4", "--halves"};
    done(halves);
    EXPECT_EQ(made_again(halves), (Words{""}));
    done({"render", scene(), "-o", in("o.%d.exr"), "--frames", "0", "--spp", "8", "--halves"});
    fs::copy_file(in("o.0.b.exr"), in("h.0.b.exr"), fs::copy_options::overwrite_existing);
    EXPECT_EQ(made_again(halves), (Words{R"(--spp (got ["8"]; expected ["4"]))"}));
    // A file that is the same for every frame may have any name.
    std::ofstream(in("s%d.toml")) << bytes_of(scene());
    EXPECT_EQ(made_again({"focus", in("f.%04d.exr"), "-o", in("x.%d.exr"), "--frames", "0", "--focus", "3",
                          "--f-number", "2", "--method", "hybrid", "--scene", in("s%d.toml")}),
              (Words{"absent"}));
    const Outcome line = run(image + Words{"--keep", "--exposure", "1"});
    EXPECT_NE(line.err.find("frame 0 (and 2 more): made again, as it was made otherwise: --exposure"),
              std::string::npos)
        << line.err;
}

TEST_F(Frames, AnErrorNamesItsFrame) {
    trace_three();
    fs::remove(in("f.0001.exr"));
    const Outcome r = run({"image", in("f.%04d.exr"), "-o", in("p.%04d.png"), "--frames", "0-2"});
    EXPECT_EQ(r.exit_code, static_cast<int>(ExitCode::invalid_input));
    EXPECT_EQ(r.err.rfind("postlens: frame 1: ", 0), 0U) << r.err;
    EXPECT_NE(r.err.find("f.0001.exr"), std::string::npos) << r.err;
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
    EXPECT_TRUE(fs::exists(in("p.0000.png")));
    EXPECT_FALSE(fs::exists(in("p.0002.png")));
    EXPECT_EQ(r.out.rfind("frame 0: ", 0), 0U) << r.out;
}

TEST_F(Frames, WarningsAreOfTheFirstFrameThatHasThem) {
    trace_three();
    const json said = done({"focus", in("f.%04d.exr"), "-o", in("p.%d.exr"), "--frames", "2,0,1",
                            "--f-number", "1", "--focus", "1"});
    ASSERT_EQ(said.at("warnings").size(), 1U) << said.at("warnings");
    const json& w = said.at("warnings").at(0);
    EXPECT_EQ(w.at("code"), "overscan");
    EXPECT_EQ(w.at("text").get<std::string>().rfind("frame 2 (and 2 more): ", 0), 0U) << w;
    for (const json& frame : said.at("frames")) EXPECT_EQ(frame.at("warnings").size(), 1U);
    EXPECT_EQ(run({"focus", in("f.%04d.exr"), "-o", in("p.%d.exr"), "--frames", "2,0,1", "--f-number", "1",
                   "--focus", "1", "--strict"})
                  .exit_code,
              static_cast<int>(ExitCode::shortfall));
}

TEST_F(Frames, WhatMeansNothingIsRefused) {
    const std::string s = scene();
    const Words trace{"trace", s, "-o", in("f.%04d.exr")};
    refused(trace, ExitCode::wrong_arguments, "holds a frame number");
    refused(trace + Words{"--frames", "1-3", "--fps", "0"}, ExitCode::wrong_arguments, "--fps");
    refused({"trace", s, "-o", in("f.exr"), "--frames", "1-3"}, ExitCode::wrong_arguments,
            "the output holds no");
    // Other printf conversions are plain text.
    refused({"trace", s, "-o", in("%s%n%4d%*d%ld.exr"), "--frames", "1-3"}, ExitCode::wrong_arguments,
            "the output holds no");
    refused({"image", in("f.exr"), "-o", in("p.%d.png"), "--frames", "1-3"}, ExitCode::wrong_arguments,
            "the input is the same");
    refused({"image", in("f.%d.exr"), "-o", in("p.png")}, ExitCode::wrong_arguments, "holds a frame number");
    refused({"image", in("f.exr"), "-o", in("p.png"), "--keep"}, ExitCode::wrong_arguments, "--keep");
    refused({"shoot", in("f.%d.exr"), "-o", in("p.%d.png"), "--frames", "1", "--explain", in("why.png")},
            ExitCode::wrong_arguments, "--explain holds no");
    for (const char* range : {"", "1-", "3-1", "1-5x0", "1,,2", "1-3,2", "99999999", "0-9999999"}) {
        refused(trace + Words{std::string("--frames=") + range}, ExitCode::wrong_arguments, "--frames: ");
    }
}

TEST_F(Frames, OtherPercentSignsAndHashesStayInTheName) {
    const std::string s = scene();
    done({"trace", s, "-o", in("100%_#1.exr")});
    EXPECT_TRUE(fs::exists(in("100%_#1.exr")));
    done({"trace", s, "-o", in("100%s_#_%02d_%d.exr"), "--frames", "123"});
    EXPECT_TRUE(fs::exists(in("100%s_#_123_123.exr")));
    done({"image", in("100%s_#_%d_%d.exr"), "-o", in("%_##.png"), "--frames", "123"});
    EXPECT_TRUE(fs::exists(in("%_123.png")));
}

}  // namespace
}  // namespace postlens::test::frames_command_test
