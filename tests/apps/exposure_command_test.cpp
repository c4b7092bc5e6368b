// The options `--exposure` and `--lumens-per-watt`.
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pictures/exposure.h"
#include "records/sample_file.h"
#include "tests/support/command_test.h"

namespace postlens::test::exposure_command_test {
namespace {

using nlohmann::json;

class ExposureCommand : public CommandTest {
  protected:
    // A floor under a point light and a sky, with all light multiplied by `brighter`.
    std::string scene(double brighter) {
        const std::string path = in(fmt::format("scene_{}.toml", brighter));
        std::ofstream(path) << fmt::format(R"(
[scene]
background = [{0}, {1}, {2}]
ambient_light = [{3}, {3}, {3}]
[[camera]]
position_m = [0, 1, 4]
look_at_m = [0, 0.5, 0]
focal_length_mm = 35
width_px = 48
height_px = 32
f_number = 2
focus_m = 4
[[light]]
kind = "point"
position_m = [1, 3, 2]
intensity = [{4}, {4}, {4}]
[[material]]
name = "m"
diffuse = [0.8, 0.6, 0.4]
[[object]]
shape = "rectangle"
corner_m = [-3, 0, -3]
edge_u_m = [0, 0, 6]
edge_v_m = [6, 0, 0]
material = "m"
)",
                                           0.1 * brighter, 0.2 * brighter, 0.3 * brighter, 0.25 * brighter,
                                           0.5 * brighter);
        return path;
    }
    json ok(std::vector<std::string> words) {
        words.emplace_back("--json");
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << words[0] << ": " << r.err;
        return r.exit_code == 0 ? json::parse(r.out) : json();
    }
    static std::vector<std::string> exposure_warnings(const json& j) {
        std::vector<std::string> out;
        for (const json& w : j.at("warnings")) {
            if (w.at("code") == "exposure") out.push_back(w.at("text"));
        }
        return out;
    }
};

TEST_F(ExposureCommand, StopsAreTheSameAsBrighterLight) {
    ok({"trace", scene(1), "-o", in("a.exr")});
    ok({"trace", scene(8), "-o", in("b.exr")});
    for (const std::string command : {"image", "focus"}) {
        ok({command, in("a.exr"), "-o", in("a.png"), "--exposure", "3"});
        ok({command, in("b.exr"), "-o", in("b.png")});
        EXPECT_EQ(read_image(in("a.png")).rgb, read_image(in("b.png")).rgb) << command;
        EXPECT_EQ(read_image(in("a.png")).exposure_stops, 3);
        // OpenEXR files hold radiance, so the exposure does not change them.
        ok({command, in("a.exr"), "-o", in("c.exr"), "--exposure", "3"});
        ok({command, in("a.exr"), "-o", in("d.exr")});
        EXPECT_EQ(read_image(in("c.exr"), PictureValues::stored).rgb, read_image(in("d.exr")).rgb) << command;
    }
    ok({"render", scene(1), "-o", in("a.png"), "--spp", "4", "--exposure", "3", "--min-contribution", "0"});
    ok({"render", scene(8), "-o", in("b.png"), "--spp", "4", "--min-contribution", "0"});
    EXPECT_EQ(read_image(in("a.png")).rgb, read_image(in("b.png")).rgb);
}

TEST_F(ExposureCommand, WhatTheTraceTookIsTheDefaultAndTheFileHoldsRadiance) {
    const json traced = ok({"trace", scene(1000), "-o", in("a.exr"), "--exposure", "auto"});
    const double stops = traced.at("exposure_stops");
    EXPECT_EQ(traced.at("auto_exposure_stops"), stops);
    EXPECT_LT(stops, -5);
    const json info = ok({"info", in("a.exr")});
    EXPECT_EQ(info.at("exposure_stops"), stops);
    ok({"trace", scene(1000), "-o", in("plain.exr")});
    const json shown = ok({"records", in("a.exr"), "--at", "20,3"}),
               plain = ok({"records", in("plain.exr"), "--at", "20,3"});
    const double got = shown["samples"][0]["nodes"][0]["rgb"][0],
                 wanted = plain["samples"][0]["nodes"][0]["rgb"][0];
    EXPECT_NEAR(got, wanted, 1e-6 * wanted);
    const json focused = ok({"focus", in("a.exr"), "-o", in("a.png")}),
               again = ok({"focus", in("plain.exr"), "-o", in("b.png"), "--exposure", "auto"});
    EXPECT_EQ(focused.at("exposure_stops"), stops);
    EXPECT_EQ(again.at("exposure_stops"), stops);
    EXPECT_TRUE(exposure_warnings(focused).empty());
    EXPECT_EQ(ok({"render", scene(1000), "-o", in("r.png"), "--spp", "1", "--exposure", "auto", "--crop",
                  "4,4,8,8", "--threads", "1"})
                  .at("exposure_stops"),
              stops);
    EXPECT_EQ(ok({"trace", scene(1000), "-o", in("t.exr"), "--exposure", "auto", "--size", "96x64",
                  "--threads", "2"})
                  .at("exposure_stops"),
              stops);
}

TEST_F(ExposureCommand, WarningsNameStopsThatHelp) {
    ok({"trace", scene(1000), "-o", in("a.exr")});
    const json bright = ok({"image", in("a.exr"), "-o", in("a.png")});
    ASSERT_EQ(exposure_warnings(bright).size(), 1U);
    const std::string text = exposure_warnings(bright)[0], before = "expected --exposure ";
    const std::size_t at = text.find(before);
    ASSERT_NE(at, std::string::npos) << text;
    const std::string stops = text.substr(at + before.size(), text.find(',', at) - at - before.size());
    EXPECT_TRUE(
        exposure_warnings(ok({"image", in("a.exr"), "-o", in("b.png"), "--exposure", stops})).empty());
    EXPECT_TRUE(exposure_warnings(ok({"image", in("a.exr"), "-o", in("a2.exr")})).empty());
    EXPECT_EQ(exposure_warnings(ok({"image", in("a.exr"), "-o", in("c.jpg"), "--exposure", "-30"})).size(),
              1U);
    // An exposure warning is not a warning that the file is insufficient, so --strict passes.
    EXPECT_EQ(run({"focus", in("a.exr"), "-o", in("d.png"), "--strict"}).exit_code, 0);
    const json swept =
        ok({"sweep", in("a.exr"), "-o", in("s"), "--f-number", "2,4", "--format", "png", "--strict"});
    EXPECT_EQ(exposure_warnings(swept).size(), 1U);
    EXPECT_TRUE(exposure_warnings(ok({"sweep", in("a.exr"), "-o", in("s2"), "--f-number", "2,4", "--format",
                                      "png", "--exposure", "auto"}))
                    .empty());
}

TEST_F(ExposureCommand, CompareTakesTheReferencesExposure) {
    ok({"trace", scene(1000), "-o", in("a.exr"), "--exposure", "auto"});
    ok({"image", in("a.exr"), "-o", in("reference.exr")});
    ok({"focus", in("a.exr"), "-o", in("image.exr"), "--exposure", "0", "--f-number", "0.1"});
    ok({"focus", in("a.exr"), "-o", in("image8.png"), "--f-number", "0.1"});
    const json c = ok({"compare", in("image.exr"), in("reference.exr")}),
               of_png = ok({"compare", in("image8.png"), in("reference.exr")});
    EXPECT_EQ(c.at("exposure_stops"), read_image(in("reference.exr")).exposure_stops);
    EXPECT_GT(c.at("psnr_db"), 10);
    EXPECT_NEAR(c.at("psnr_db"), of_png.at("psnr_db"), 0.1);
    const json other = ok({"compare", in("image.exr"), in("reference.exr"), "--exposure", "0"});
    EXPECT_EQ(other.at("exposure_stops"), 0);
    EXPECT_NE(other.at("psnr_db"), c.at("psnr_db"));
    // With automatic exposure, a brighter scene has the same error.
    ok({"trace", scene(1), "-o", in("b.exr"), "--exposure", "auto"});
    ok({"image", in("b.exr"), "-o", in("r.exr")});
    ok({"focus", in("b.exr"), "-o", in("i.exr"), "--f-number", "0.1"});
    EXPECT_NEAR(ok({"compare", in("i.exr"), in("r.exr")}).at("psnr_db"), c.at("psnr_db"), 1e-3);
}

TEST_F(ExposureCommand, HybridTracesAgainAtTheFilesExposure) {
    ok({"trace", scene(1000), "-o", in("a.exr"), "--exposure", "auto"});
    ok({"trace", scene(1000), "-o", in("b.exr")});
    ok({"focus", in("a.exr"), "-o", in("a1.exr"), "--method", "hybrid", "--scene", scene(1000)});
    ok({"focus", in("b.exr"), "-o", in("b1.exr"), "--method", "hybrid", "--scene", scene(1000), "--exposure",
        "auto"});
    EXPECT_GT(ok({"compare", in("a1.exr"), in("b1.exr")}).at("psnr_db"), 60);
}

TEST_F(ExposureCommand, ASequenceHasOneExposure) {
    ok({"trace", scene(1), "-o", in("f.0001.exr")});
    ok({"trace", scene(4), "-o", in("f.0002.exr")});
    const json j =
        ok({"image", in("f.%04d.exr"), "-o", in("f.%04d.png"), "--frames", "1-2", "--exposure", "auto"});
    EXPECT_EQ(j["frames"][0]["exposure_stops"], j["frames"][1]["exposure_stops"]);
    EXPECT_EQ(j["frames"][0]["exposure_stops"], ok({"info", in("f.0001.exr")}).at("auto_exposure_stops"));
}

TEST_F(ExposureCommand, RefusesWhatAreNoStops) {
    scene(1);
    for (const char* bad : {"x", "101", "-101", "nan", "inf"})
        refused({"trace", in("scene_1.toml"), "-o", in("a.exr"), "--exposure", bad},
                ExitCode::wrong_arguments, "--exposure");
    for (const char* bad : {"0", "-1", "1e7", "x"})
        refused({"trace", in("scene_1.toml"), "-o", in("a.exr"), "--lumens-per-watt", bad},
                ExitCode::wrong_arguments, "--lumens-per-watt");
}

}  // namespace
}  // namespace postlens::test::exposure_command_test
