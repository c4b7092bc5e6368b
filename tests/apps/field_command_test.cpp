// The commands `focus --method lightfield|hybrid` and `shoot`: output, files and rejected arguments.
#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pictures/image.h"
#include "tests/support/command_test.h"

namespace postlens::test::field_command_test {
namespace {

using nlohmann::json;

constexpr const char* scene_text =
    "[scene]\nambient_light = 0\n[[camera]]\nfocal_length_mm = 50\nf_number = 0.7\nfocus_m = 8\nexposure_s = "
    "1\n"
    "[[material]]\nname = \"m\"\nambient = 0\ndiffuse = 0\nemission = 0.8\n"
    "[[material]]\nname = \"w\"\nambient = 0\ndiffuse = 0\nemission = 0.2\n"
    "[[object]]\nname = \"wall\"\nshape = \"rectangle\"\nmaterial = \"w\"\ncorner_m = [-9, -9, -8]\n"
    "edge_u_m = [18, 0, 0]\nedge_v_m = [0, 18, 0]\n"
    "[[object]]\nname = \"plate\"\nshape = \"rectangle\"\nmaterial = \"m\"\ncorner_m = [-0.1, -0.1, -1]\n"
    "edge_u_m = [0.1, 0, 0]\nedge_v_m = [0, 0.2, 0]\n"
    "keys = [{ time_s = 0, translate_m = [0, 0, 0] }, { time_s = 1, translate_m = [0.2, 0, 0] }]\n";

class FieldCommand : public CommandTest {
  protected:
    void SetUp() override {
        std::ofstream(in("scene.toml")) << scene_text;
        ASSERT_EQ(
            run({"trace", in("scene.toml"), "-o", in("frame.exr"), "--size", "64x36", "--overscan", "16"})
                .exit_code,
            0);
    }
    Outcome focus(const Words& options) {
        Words words{"focus", in("frame.exr"), "-o", in("out.exr"), "--json"};
        words.insert(words.end(), options.begin(), options.end());
        return run(words);
    }
    Outcome shoot(const Words& options) {
        Words words{"shoot", in("frame.exr"), "-o", in("out.exr"), "--json"};
        words.insert(words.end(), options.begin(), options.end());
        return run(words);
    }
};

// A dark cap lies hidden just behind the end of the cylinder that it closes. The planes that approximate
// curved surfaces must not reveal it. `layers` reaches 56.7 dB.
TEST_F(FieldCommand, CapsInsideCylindersStayHidden) {
    const std::string scene = POSTLENS_TEST_DATA "/nff/joints.nff";
    const Words size{"--size", "160x120", "--metres-per-unit", "0.5"};
    const auto done = [&](Words words, const Words& more) {
        words.insert(words.end(), more.begin(), more.end());
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return r.out;
    };
    done({"trace", scene, "-o", in("joints.exr"), "--for-f-number", "0.7", "--for-focus", "3"}, size);
    for (const char* f_number : {"0.7", "8"}) {
        const Words lens{"--f-number", f_number, "--focus", "3"};
        Words rays = size;
        rays.insert(rays.end(), lens.begin(), lens.end());
        done({"render", scene, "-o", in("rays.exr"), "--spp", "256"}, rays);
        done({"focus", in("joints.exr"), "-o", in("views.exr"), "--method", "lightfield", "--views", "64"},
             lens);
        const json j = json::parse(done({"compare", in("views.exr"), in("rays.exr"), "--json"}, {}));
        EXPECT_GT(j.at("psnr_db").get<double>(), 56) << f_number;
    }
}

// The camera is at the origin, so that it does not tell the unit of the scene.
TEST_F(FieldCommand, RaysTakeTheUnitsOfTheTrace) {
    const Words trace{"trace", in("scene.toml"), "-o", in("frame.exr"), "--size", "64x36"};
    const Words rays{"--scene", in("scene.toml"), "--f-number", "0.7", "--focus", "2"};
    const auto made = [&](const Words& more) {
        Words words = rays;
        words.insert(words.end(), more.begin(), more.end());
        const Outcome r = focus(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return bytes_of(in("out.exr"));
    };
    Words quarter = trace;
    quarter.insert(quarter.end(), {"--metres-per-unit", "0.25"});
    ASSERT_EQ(run(quarter).exit_code, 0);
    EXPECT_EQ(json::parse(run({"info", in("frame.exr"), "--json"}).out).at("metres_per_unit"), 0.25);
    EXPECT_TRUE(made({"--method", "hybrid"}) == made({"--method", "hybrid", "--metres-per-unit", "0.25"}));
    const std::string wrong = "--metres-per-unit: other than in the trace (got 1; expected 0.25)";
    for (const char* method : {"hybrid", "auto"}) {
        Words words{"focus", in("frame.exr"),     "-o", in("x.exr"), "--method",
                    method,  "--metres-per-unit", "1"};
        words.insert(words.end(), rays.begin(), rays.end());
        refused(words, ExitCode::wrong_arguments, wrong);
    }
    refused({"compare", in("out.exr"), in("out.exr"), "--map-causes", in("x.png"), "--frame", in("frame.exr"),
             "--f-number", "0.7", "--focus", "2", "--scene", in("scene.toml"), "--metres-per-unit", "1"},
            ExitCode::wrong_arguments, wrong);
    ASSERT_EQ(run(trace).exit_code, 0);
    EXPECT_EQ(json::parse(run({"info", in("frame.exr"), "--json"}).out).at("metres_per_unit"), 1);
    const std::string lit = POSTLENS_SAMPLES "/scenes/blender_still.glb";
    ASSERT_EQ(run({"trace", lit, "-o", in("lit.exr"), "--size", "16x9"}).exit_code, 0);
    refused({"focus", in("lit.exr"), "-o", in("x.exr"), "--f-number", "2", "--focus", "5", "--method",
             "hybrid", "--scene", lit, "--lumens-per-watt", "100"},
            ExitCode::wrong_arguments, "--lumens-per-watt: other than in the trace (got 100; expected 683)");
}

TEST_F(FieldCommand, LightFieldSaysItsViewsAndWhatWasNotRecorded) {
    const Outcome r = focus({"--method", "lightfield", "--views", "32"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json j = json::parse(r.out);
    EXPECT_EQ(j["method"], "lightfield");
    EXPECT_EQ(j["views"], 32);
    ASSERT_EQ(j["warnings"].size(), 1);
    EXPECT_EQ(j["warnings"][0]["code"], "uncovered");
    EXPECT_EQ(focus({"--method", "lightfield", "--strict"}).exit_code, 6);
    EXPECT_EQ(read_image(in("out.exr")).width, 64);
}

TEST_F(FieldCommand, HybridTracesAgainWithTheFilesOwnSceneOnly) {
    const Outcome r = focus(
        {"--method", "hybrid", "--views", "16", "--scene", in("scene.toml"), "--explain", in("what.png")});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json j = json::parse(r.out);
    EXPECT_EQ(j["method"], "hybrid");
    EXPECT_GT(j["retraced_share"], 0);
    EXPECT_LE(j["retraced_share"], 1);
    EXPECT_GT(j["rays"]["eye"], 0);
    EXPECT_EQ(read_image(in("what.png")).height, 36);

    std::ofstream(in("other.toml")) << scene_text << "\n# changed\n";
    const Outcome other = focus({"--method", "hybrid", "--scene", in("other.toml")});
    EXPECT_EQ(other.exit_code, 3);
    EXPECT_NE(other.err.find("SHA-256"), std::string::npos) << other.err;
    EXPECT_EQ(focus({"--method", "hybrid", "--scene", in("none.toml")}).exit_code, 3);
    EXPECT_EQ(focus({"--method", "hybrid", "--framing", "lens"}).exit_code, 2);
}

TEST_F(FieldCommand, MissingOverscanIsSaidAsByLayers) {
    ASSERT_EQ(run({"trace", in("scene.toml"), "-o", in("narrow.exr"), "--size", "64x36", "--overscan", "0"})
                  .exit_code,
              0);
    const auto share = [&](const char* method) {
        const Outcome r = run({"focus", in("narrow.exr"), "-o", in("out.exr"), "--json", "--method", method,
                               "--f-number", "0.7", "--focus", "2"});
        EXPECT_EQ(r.exit_code, 0) << r.err;
        const json result = json::parse(r.out);
        for (const json& warning : result.at("warnings")) {
            if (warning["code"] == "overscan") return warning["share"].get<double>();
        }
        return 0.0;
    };
    EXPECT_GT(share("layers"), 0);
    EXPECT_EQ(share("lightfield"), share("layers"));
}

TEST_F(FieldCommand, RaysAreAsRightThroughAPinhole) {
    for (const char* method : {"hybrid", "auto"}) {
        const Outcome r = focus({"--method", method, "--scene", in("scene.toml"), "--f-number", "inf"});
        ASSERT_EQ(r.exit_code, 0) << r.err;
        const json j = json::parse(r.out);
        EXPECT_EQ(j["method"], method);
        EXPECT_GT(j["stated_db"], 39);
        // Without a scene there is nothing to look at but the records.
        const Outcome alone = focus({"--method", method, "--f-number", "inf"});
        EXPECT_EQ(json::parse(alone.out)["method"], "pinhole");
    }
}

TEST_F(FieldCommand, WhatHasNoPointsOfALensIsRefusedByName) {
    for (const char* method : {"lightfield", "hybrid"}) {
        const Outcome r = focus({"--method", method, "--impulse", "diffraction"});
        EXPECT_EQ(r.exit_code, 2) << method;
        EXPECT_NE(r.err.find("diffraction"), std::string::npos) << r.err;
        EXPECT_EQ(focus({"--method", method, "--views", "0"}).exit_code, 2);
        EXPECT_EQ(focus({"--method", method, "--views", "4097"}).exit_code, 2);
    }
    EXPECT_EQ(focus({"--method", "lightfield", "--depth-model", "path"}).exit_code, 2);
}

TEST_F(FieldCommand, EveryMethodSaysWhatItExpectsToBeOffBy) {
    for (const char* method : {"scatter", "layers", "lightfield", "hybrid"}) {
        const Outcome plain = focus({"--method", method});
        ASSERT_EQ(plain.exit_code, 0) << plain.err;
        EXPECT_TRUE(json::parse(plain.out)["predicted_db"].is_null()) << method;
        const Image before = read_image(in("out.exr"));
        const Outcome r = focus({"--method", method, "--predict"});
        ASSERT_EQ(r.exit_code, 0) << r.err;
        const json j = json::parse(r.out);
        EXPECT_GT(j["predicted_db"], 15) << method;
        EXPECT_LT(j["bound_db"], j["predicted_db"]) << method;
        EXPECT_GT(j["unsure_share"], 0) << method;
        ASSERT_EQ(j["prediction"]["tiles"].size(), 1U);
        const json& tile = j["prediction"]["tiles"][0];
        const auto db = [](double mse) { return -10 * std::log10(std::max(mse, 1e-12)); };
        const double mse = tile["method_mse"], bound = tile["bound_mse"];
        EXPECT_NEAR(j["predicted_db"], db(mse), 1e-6) << method;
        EXPECT_NEAR(j["bound_db"], db(std::pow(std::sqrt(mse) + std::sqrt(bound), 2)), 1e-6) << method;
        EXPECT_EQ(read_image(in("out.exr")).rgb, before.rgb) << method;
    }
    const Outcome shot = shoot({"--predict", "--views", "16"});
    ASSERT_EQ(shot.exit_code, 0) << shot.err;
    EXPECT_GT(json::parse(shot.out)["predicted_db"], 15);
    const Outcome blurred =
        run({"motionblur", in("frame.exr"), "-o", in("out.exr"), "--shutter", "0:1", "--predict", "--json"});
    ASSERT_EQ(blurred.exit_code, 0) << blurred.err;
    EXPECT_GT(json::parse(blurred.out)["predicted_db"], 15);
    const Outcome text = run({"focus", in("frame.exr"), "-o", in("out.exr"), "--predict"});
    EXPECT_NE(text.out.find(" dB without the error of the records"), std::string::npos) << text.out;
    // Rejected before any output is written.
    std::filesystem::remove(in("out.exr"));
    for (const Words& options : {Words{"--impulse", "diffraction"}, Words{"--framing", "lens"},
                                 Words{"--method", "pinhole"}, Words{"--f-number", "inf"}}) {
        Words words{"focus", in("frame.exr"), "-o", in("out.exr"), "--predict"};
        words.insert(words.end(), options.begin(), options.end());
        refused(words, ExitCode::wrong_arguments, "--predict");
    }
    EXPECT_FALSE(std::filesystem::exists(in("out.exr")));
}

TEST_F(FieldCommand, ShootTakesTheFilesExposureUnlessToldOtherwise) {
    const Outcome r = shoot({"--views", "32"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json j = json::parse(r.out);
    EXPECT_EQ(j["shutter_open_s"], 0);
    EXPECT_EQ(j["shutter_close_s"], 1);
    EXPECT_EQ(j["f_number"], 0.7);
    const Image moving = read_image(in("out.exr"));
    // A shutter that only covers the frame's instant gives the light field.
    ASSERT_EQ(shoot({"--views", "32", "--shutter", "0:0"}).exit_code, 0);
    const Image still = read_image(in("out.exr"));
    ASSERT_EQ(focus({"--method", "lightfield", "--views", "32"}).exit_code, 0);
    EXPECT_EQ(read_image(in("out.exr")).rgb, still.rgb);
    EXPECT_NE(moving.rgb, still.rgb);
    EXPECT_EQ(shoot({"--shutter", "1:0"}).exit_code, 2);
    EXPECT_EQ(shoot({"--shutter", "0:1", "--paths", in("none.toml")}).exit_code, 3);
    EXPECT_EQ(shoot({"--method", "hybrid", "--scene", in("scene.toml"), "--shutter", "0:1"}).exit_code, 0);
}

}  // namespace
}  // namespace postlens::test::field_command_test
