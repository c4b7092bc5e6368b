// The command `sweep`: output, files and rejected arguments.
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pictures/image.h"
#include "tests/support/command_test.h"

namespace postlens::test::sweep_command_test {
namespace {

using nlohmann::json;

constexpr const char* scene_text =
    "[scene]\nambient_light = 0\n[[camera]]\nfocal_length_mm = 50\nf_number = 0.7\nfocus_m = 8\n"
    "[[material]]\nname = \"m\"\nambient = 0\ndiffuse = 0\nemission = 0.8\n"
    "[[material]]\nname = \"w\"\nambient = 0\ndiffuse = 0\nemission = 0.2\n"
    "[[object]]\nname = \"wall\"\nshape = \"rectangle\"\nmaterial = \"w\"\ncorner_m = [-9, -9, -8]\n"
    "edge_u_m = [18, 0, 0]\nedge_v_m = [0, 18, 0]\n"
    "[[object]]\nname = \"plate\"\nshape = \"rectangle\"\nmaterial = \"m\"\ncorner_m = [-0.1, -0.1, -1]\n"
    "edge_u_m = [0.1, 0, 0]\nedge_v_m = [0, 0.2, 0]\n"
    "keys = [{ time_s = 0, translate_m = [0, 0, 0] }, { time_s = 1, translate_m = [0.2, 0, 0] }]\n";

class SweepCommand : public CommandTest {
  protected:
    void SetUp() override {
        std::ofstream(in("scene.toml")) << scene_text;
        ASSERT_EQ(run({"trace", in("scene.toml"), "-o", in("frame.exr"), "--size", "64x36", "--overscan",
                       "16", "--for-shutter", "0:1"})
                      .exit_code,
                  0);
    }
    Outcome sweep(const Words& options) {
        Words words{"sweep", in("frame.exr"), "-o", in("out"), "--json"};
        words.insert(words.end(), options.begin(), options.end());
        return run(words);
    }
};

TEST_F(SweepCommand, MakesEveryCombinationAsFocusDoes) {
    const Outcome r = sweep({"--f-number", "1.4:2.8:1", "--focus", "1,inf"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json j = json::parse(r.out);
    ASSERT_EQ(j["pictures"].size(), 6);
    EXPECT_EQ(j["made"], 6);
    EXPECT_EQ(j["pictures"][1]["file"], "f1.4_sinf.exr");
    EXPECT_EQ(j["pictures"][1]["focus_m"], nullptr);
    EXPECT_EQ(j["pictures"][0]["predicted_db"], nullptr);
    EXPECT_EQ(j["pictures"][0]["at"].size(), 9);
    ASSERT_EQ(
        run({"focus", in("frame.exr"), "-o", in("one.exr"), "--f-number", "1.4", "--focus", "1"}).exit_code,
        0);
    EXPECT_EQ(read_image(in("one.exr")).rgb, read_image(in("out/f1.4_s1.exr")).rgb);
    for (const char* name : {"out/sweep.csv", "out/sweep.json", "out/contact.png"})
        EXPECT_TRUE(std::filesystem::exists(in(name))) << name;
    EXPECT_EQ(json::parse(sweep({"--f-number", "1.4:2.8:1", "--focus", "1,inf", "--resume"}).out)["kept"], 6);
}

TEST_F(SweepCommand, OnePictureIsNotPictures) {
    const Outcome r = run({"sweep", in("frame.exr"), "-o", in("out"), "--f-number", "2", "--focus", "1"});
    EXPECT_NE(r.out.find(": 1 picture (1 made, 0 kept)"), std::string::npos) << r.out;
}

TEST_F(SweepCommand, PredictsEveryPictureIfAsked) {
    const Words lenses{"--f-number", "1.4,inf", "--focus", "2"};
    ASSERT_EQ(sweep(lenses).exit_code, 0);
    const auto with = [&](const Words& more) {
        Words words = lenses;
        words.insert(words.end(), more.begin(), more.end());
        return sweep(words);
    };
    // Images that were made without --predict are made again.
    for (const char* method : {"scatter", "lightfield"}) {
        const Outcome r = with({"--predict", "--resume", "--method", method});
        ASSERT_EQ(r.exit_code, 0) << r.err;
        const json j = json::parse(r.out);
        EXPECT_EQ(j["made"], 2);
        ASSERT_EQ(run({"focus", in("frame.exr"), "-o", in("one.exr"), "--f-number", "1.4", "--focus", "2",
                       "--method", method, "--predict", "--json"})
                      .exit_code,
                  0);
        EXPECT_GT(j["pictures"][0]["predicted_db"], 15) << method;
        // The image of a pinhole is the mean of its records, so there is no error to predict.
        EXPECT_EQ(j["pictures"][1]["predicted_db"], nullptr) << method;
    }
    EXPECT_EQ(json::parse(with({"--predict", "--resume", "--method", "lightfield"}).out)["kept"], 2);
    // What was predicted stays for a run that does not ask for it, and for the next that does.
    EXPECT_EQ(json::parse(with({"--resume", "--method", "lightfield"}).out)["kept"], 2);
    EXPECT_EQ(json::parse(with({"--predict", "--resume", "--method", "lightfield"}).out)["kept"], 2);
    const Outcome shot = with({"--predict", "--shutter", "0:0.5", "--views", "16"});
    ASSERT_EQ(shot.exit_code, 0) << shot.err;
    const json report = json::parse(shot.out);
    for (const json& picture : report["pictures"]) EXPECT_GT(picture["predicted_db"], 15);
    EXPECT_EQ(with({"--predict", "--impulse", "disc,diffraction"}).exit_code, 2);
}

TEST_F(SweepCommand, PullsFocusWithTheShutterOpen) {
    const Outcome r = sweep({"--focus", "8:1:3", "--shutter", "0:0.5", "--f-number", "2,inf", "--views", "16",
                             "--frames", "pull.%04d.png", "--at", "30,20", "--at", "1,1", "--threads", "2"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json j = json::parse(r.out);
    ASSERT_EQ(j["pictures"].size(), 6);
    EXPECT_EQ(j["pictures"][0]["method"], "lightfield");
    EXPECT_EQ(j["pictures"][5]["method"], "motionblur");
    EXPECT_EQ(j["pictures"][0]["at"].size(), 2);
    ASSERT_EQ(run({"shoot", in("frame.exr"), "-o", in("one.png"), "--shutter", "0:0.5", "--f-number", "2",
                   "--focus", "8", "--views", "16"})
                  .exit_code,
              0);
    EXPECT_EQ(bytes_of(in("one.png")), bytes_of(in("out/pull.0001.png")));
    ASSERT_EQ(run({"motionblur", in("frame.exr"), "-o", in("two.png"), "--shutter", "0:0.5"}).exit_code, 0);
    EXPECT_EQ(read_image(in("two.png")).width, read_image(in("out/pull.0006.png")).width);
}

TEST_F(SweepCommand, SharesJoinToTheSweepOfAll) {
    const std::vector<std::string> axes{"--f-number", "1.4,2.8,5.6", "--focus", "1,2", "--method", "scatter"};
    const auto sweep = [&](const std::string& folder, std::vector<std::string> more) {
        std::vector<std::string> words{"sweep", in("frame.exr"), "-o", in(folder), "--json"};
        words.insert(words.end(), axes.begin(), axes.end());
        words.insert(words.end(), more.begin(), more.end());
        const auto r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return json::parse(r.out);
    };
    sweep("whole", {});
    for (const char* share : {"2/4", "0/4", "3/4", "1/4"}) {
        const json said = sweep("shared", {"--share", share});
        EXPECT_EQ(said["made"], share[0] < '2' ? 2 : 1);
        EXPECT_TRUE(said["csv"].is_null());
    }
    EXPECT_FALSE(std::filesystem::exists(in("shared/sweep.csv")));
    const json joined = sweep("shared", {"--resume"});
    EXPECT_EQ(joined["made"], 0);
    EXPECT_EQ(joined["kept"], 6);
    for (const auto& entry : std::filesystem::directory_iterator(in("whole"))) {
        const std::string name = entry.path().filename().string();
        const auto bytes = [&](const std::string& folder) {
            std::ifstream file(std::filesystem::path(in(folder)) / name, std::ios::binary);
            EXPECT_TRUE(file) << folder << "/" << name;
            return std::string(std::istreambuf_iterator<char>(file), {});
        };
        // Tables hold the seconds that each picture took.
        if (name.ends_with(".exr") || name.ends_with(".png")) {
            EXPECT_TRUE(bytes("whole") == bytes("shared")) << name;
        }
    }
    // A share that was stopped goes on with what it has.
    EXPECT_EQ(sweep("shared", {"--share", "0/4", "--resume"})["kept"], 2);
}

TEST_F(SweepCommand, AWarningCountsEachPictureOnce) {
    // Both pictures warn of missing surfaces twice: of those behind edges, and of those in mirrors.
    ASSERT_EQ(run({"trace", POSTLENS_SAMPLES "/scenes/still_life.toml", "-o", in("frame.exr"), "--size",
                   "64x36", "--subdivide", "0"})
                  .exit_code,
              0);
    const Outcome r =
        sweep({"--f-number", "1.8", "--focus", "0.8,3", "--method", "lightfield", "--views", "4"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json warnings = json::parse(r.out)["warnings"];
    EXPECT_NE(r.out.find("2 of 2 pictures"), std::string::npos) << r.out;
    for (const json& w : warnings)
        EXPECT_EQ(w["text"].get<std::string>().find("4 of 2 pictures"), std::string::npos) << w;
}

TEST_F(SweepCommand, RefusesInOneLine) {
    std::ofstream(in("file")) << "x";
    const auto refuse = [this](const Words& options, ExitCode code, const std::string& part,
                               const std::string& out = "out") {
        Words words{"sweep", in("frame.exr"), "-o", out == "out" ? in(out) : out};
        words.insert(words.end(), options.begin(), options.end());
        refused(words, code, part);
        EXPECT_FALSE(std::filesystem::exists(in("out"))) << part;
    };
    refuse({"--f-number", "16:1.4:1"}, ExitCode::wrong_arguments, "backwards");
    refuse({"--f-number", "1.4:16:0"}, ExitCode::wrong_arguments, "step");
    refuse({"--f-number", ""}, ExitCode::wrong_arguments, "--f-number");
    refuse({"--focus", "1:5:0"}, ExitCode::wrong_arguments, "empty range");
    refuse({"--focus", "1:9:100", "--f-number", "1:1000:1/50"}, ExitCode::wrong_arguments,
           "too many combinations (got 99800");
    refuse({"--method", "magic"}, ExitCode::wrong_arguments, "magic");
    refuse({"--method", "scatter", "--shutter", "0:1"}, ExitCode::wrong_arguments, "--method");
    refuse({"--format", "gif"}, ExitCode::wrong_arguments, "gif");
    refuse({"--frames", "a%d.png", "--format", "exr"}, ExitCode::wrong_arguments, "--frames");
    refuse({"--at", "999,1"}, ExitCode::wrong_arguments, "--at");
    refuse({"--depths", "1"}, ExitCode::wrong_arguments, "depths");
    refuse({"--views", "0", "--method", "lightfield"}, ExitCode::wrong_arguments, "views");
    refuse({}, ExitCode::cannot_write, "is a file", in("file"));
    refuse({}, ExitCode::cannot_write, "/proc/none", "/proc/none");
    refused({"sweep", in("scene.toml"), "-o", in("out")}, ExitCode::invalid_input, "scene.toml");
    EXPECT_EQ(run({"sweep", in("frame.exr")}).exit_code, 2);
}

}  // namespace
}  // namespace postlens::test::sweep_command_test
