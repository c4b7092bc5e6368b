// The command `motionblur`: output, exit codes, and rejected arguments that leave no files.
#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "pictures/image.h"
#include "records/sample_file.h"
#include "tests/support/command_test.h"
#include "tests/support/random_records.h"

namespace postlens::test::motionblur_command_test {
namespace {

using nlohmann::json;

constexpr const char* camera = "[scene]\nambient_light = 0\n[[camera]]\nfocal_length_mm = 50\n";
constexpr const char* materials =
    "[[material]]\nname = \"m\"\nambient = 0\ndiffuse = 0\nemission = 0.8\n"
    "[[material]]\nname = \"w\"\nambient = 0\ndiffuse = 0\nemission = 0.2\n";
// A wall behind a plate that moves by 22 px to the right in an image of 64 px.
constexpr const char* wall =
    "[[object]]\nname = \"wall\"\nshape = \"rectangle\"\nmaterial = \"w\"\ncorner_m = [-9, -9, -8]\n"
    "edge_u_m = [18, 0, 0]\nedge_v_m = [0, 18, 0]\n";
constexpr const char* plate =
    "[[object]]\nname = \"plate\"\nshape = \"rectangle\"\nmaterial = \"m\"\ncorner_m = [-1, -0.5, -4]\n"
    "edge_u_m = [1, 0, 0]\nedge_v_m = [0, 1, 0]\n"
    "keys = [{ time_s = 0, translate_m = [0, 0, 0] }, { time_s = 1, translate_m = [1, 0, 0] }]\n";

class MotionblurCommand : public CommandTest {
  protected:
    std::string write(const std::string& name, const std::string& text) {
        std::ofstream(in(name), std::ios::binary) << text;
        return in(name);
    }
    // Traces the scene `text` into NAME.exr and returns its path.
    std::string traced(const std::string& name, const std::string& text, const Words& options = {},
                       const std::string& size = "64x36") {
        Words words{"trace", write(name + ".toml", text), "-o", in(name + ".exr"), "--size", size, "--quiet"};
        words.insert(words.end(), options.begin(), options.end());
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return in(name + ".exr");
    }
    std::string moving_plate() {
        return traced("a", std::string(camera) + "exposure_s = 0.5\n" + materials + wall + plate,
                      {"--for-shutter", "0:1"});
    }
    Outcome blur(const std::string& frame, const Words& options, const std::string& before = "") {
        Words words{"motionblur", frame, "-o", in("out.exr")};
        words.insert(words.end(), options.begin(), options.end());
        return run(words, before);
    }
    json blurred(const std::string& frame, Words options, int exit_code = 0) {
        options.emplace_back("--json");
        const Outcome r = blur(frame, options);
        EXPECT_EQ(r.exit_code, exit_code) << r.err;
        return r.out.empty() ? json() : json::parse(r.out);
    }
    void not_blurred(const std::string& frame, const Words& options, ExitCode code, const std::string& part) {
        Words words{"motionblur", frame, "-o", in("refused.exr")};
        words.insert(words.end(), options.begin(), options.end());
        refused(words, code, part);
    }
    static Words codes(const json& result) {
        Words out;
        for (const json& w : result.at("warnings")) out.push_back(w.at("code"));
        return out;
    }
    static bool warns(const json& result, const std::string& code) {
        const Words all = codes(result);
        return std::find(all.begin(), all.end(), code) != all.end();
    }
    Image picture() { return read_image(in("out.exr")); }
};

TEST_F(MotionblurCommand, WithTheSceneRaysGoWhereTheViewsAreUnsure) {
    const std::string frame = moving_plate(), scene = in("a.toml");
    for (const std::string method : {"auto", "lightfield"}) {
        const Words lens = method == "auto" ? Words{"--method", "auto", "--target-db", "38"}
                                            : Words{"--method", "hybrid", "--views", "64"};
        Words shoot{"shoot",   frame, "-o",         in("shot.exr"), "--shutter", "0:0.5",
                    "--scene", scene, "--f-number", "inf",          "--focus",   "1"};
        shoot.insert(shoot.end(), lens.begin(), lens.end());
        ASSERT_EQ(run(shoot).exit_code, 0);
        Words words{"--scene", scene, "--method", method};
        words.insert(words.end(), lens.begin() + 2, lens.end());
        const json said = blurred(frame, words);
        EXPECT_GT(said.at("retraced_share").get<double>(), 0) << method;
        EXPECT_TRUE(said.contains("stated_db")) << method;
        EXPECT_EQ(read_image(in("out.exr")).rgb, read_image(in("shot.exr")).rgb) << method;
    }
    // As right as rays: the noise of the reference is well below the error that is allowed.
    ASSERT_EQ(run({"render", scene, "-o", in("rays.exr"), "--size", "64x36", "--spp", "1024", "--shutter",
                   "0:0.5", "--f-number", "inf"})
                  .exit_code,
              0);
    const Outcome compared = run({"compare", in("out.exr"), in("rays.exr"), "--json"});
    EXPECT_GT(json::parse(compared.out).at("psnr_db").get<double>(), 38);
    const auto two = ExitCode::wrong_arguments;
    not_blurred(frame, {"--target-db", "40"}, two, "--scene");
    not_blurred(frame, {"--target-db", "40", "--scene", scene, "--method", "lightfield"}, two, "--target-db");
    // The focus for which a file was traced does not matter to a pinhole.
    const std::string lens = traced("l", std::string(camera) + materials + wall + plate,
                                    {"--for-shutter", "0:1", "--for-f-number", "2", "--for-focus", "3"});
    blurred(lens, {"--scene", in("l.toml"), "--shutter", "0:0.5", "--method", "lightfield", "--views", "8",
                   "--strict"});
    not_blurred(frame, {"--scene", scene, "--method", "convolve"}, two, "--method convolve");
    not_blurred(frame, {"--scene", in("none.toml")}, ExitCode::invalid_input, "none.toml");
    not_blurred(frame, {"--scene", scene, "--share", "0/2"}, two, "--share");
}

TEST_F(MotionblurCommand, SaysWhatItDid) {
    const std::string frame = moving_plate();
    const json j = blurred(frame, {"--shutter", "0:1"});
    for (const char* key : {"method", "views", "depths", "predicted_db", "retraced_share", "focus_m",
                            "focal_length_mm", "f_number", "seconds", "warnings", "objects"})
        EXPECT_TRUE(j.contains(key)) << key;
    EXPECT_EQ(j["method"], "convolve");
    EXPECT_TRUE(j["views"].is_null());
    EXPECT_EQ(j["focal_length_mm"], 50);
    EXPECT_EQ(j["shutter_close_s"], 1);
    EXPECT_TRUE(j["warnings"].empty()) << j["warnings"];
    ASSERT_EQ(j["objects"].size(), 1U);
    EXPECT_EQ(j["objects"][0]["name"], "plate");
    EXPECT_EQ(j["objects"][0]["motion"], "translation");
    EXPECT_NEAR(j["objects"][0]["move_px"], 50.0 / 36 * 64 / 4, 1e-3);  // 1 m at 4 m; depths are floats
    EXPECT_EQ(j["objects"][0]["method"], "convolve");
    // The plate moves over 44.4 x 22.2 of 64 x 36 px.
    EXPECT_NEAR(j["touched_share"], 44.4 * 22.2 / (64 * 36), 2 * (44.4 + 22.2) / (64 * 36));
    const Outcome text = blur(frame, {"--shutter", "0:1"});
    EXPECT_NE(text.out.find("plate: convolve (moves as a whole"), std::string::npos) << text.out;
    EXPECT_TRUE(text.err.empty()) << text.err;
    EXPECT_TRUE(blur(frame, {"--shutter", "0:1", "--quiet"}).out.empty());
}

TEST_F(MotionblurCommand, TheShutterIsTheFilesExposureUnlessNamed) {
    const std::string frame = moving_plate();
    const json j = blurred(frame, {});
    EXPECT_EQ(j["shutter_open_s"], 0);
    EXPECT_EQ(j["shutter_close_s"], 0.5);
    const std::string by_itself = bytes_of(in("out.exr"));
    (void)blurred(frame, {"--shutter", "0:0.5"});
    EXPECT_TRUE(by_itself == bytes_of(in("out.exr")));
    const std::string none = traced("none", std::string(camera) + materials + wall + plate);
    not_blurred(none, {}, ExitCode::wrong_arguments, "--shutter: missing");
}

TEST_F(MotionblurCommand, ShuttersThatMakeNoSense) {
    const std::string frame = moving_plate();
    for (const char* text : {"1:0", "0.5:-1", "nan:1", "0:nan", "0:inf", "-inf:0", "0", ":", "0:", ":1", "",
                             "0:1:2", "0,1", "a:b", "0:1e999", "1e400:1e401", "-1e308:1e308"})
        not_blurred(frame, {std::string("--shutter=") + text}, ExitCode::wrong_arguments, "--shutter");
    // An instant, and times far beyond all keys, are valid.
    for (const char* text : {"0:0", "0.5:0.5", "-1e9:1e9", "-5:-4", "1e-300:2e-300"})
        EXPECT_EQ(blur(frame, {std::string("--shutter=") + text}).exit_code, 0) << text;
}

TEST_F(MotionblurCommand, ZeroExposureIsThePinholePicture) {
    const std::string frame = moving_plate();
    EXPECT_EQ(run({"image", frame, "-o", in("still.exr"), "--quiet"}).exit_code, 0);
    for (const char* method : {"auto", "convolve", "lightfield"}) {
        (void)blurred(frame, {"--shutter", "0:0", "--method", method});
        EXPECT_EQ(picture().rgb, read_image(in("still.exr")).rgb) << method;
    }
}

TEST_F(MotionblurCommand, CurvesOfTheShutter) {
    const std::string frame = moving_plate();
    const auto at = [&](const std::string& curve, const char* method) {
        (void)blurred(frame, {"--shutter", "0:1", "--shutter-curve", curve, "--method", method});
        return static_cast<double>(picture().pixel(21, 18)[0]);
    };
    // The plate is 22.2 px long, and its left edge passes x at t = (x - 9.8) / 22.2, which is the middle of
    // pixel 21 at t = 0.53. A shutter that is open only in the first half sees the plate there all the time.
    const std::string first_half = write("curve.txt", "0 1\n0.5 1\n0.5001 0\n1 0\n");
    for (const char* method : {"convolve", "lightfield"}) {
        const double box = at("box", method), triangle = at("triangle", method);
        // Fraction of the light until then: 0.527 for a box, 1 - 2 (1 - 0.527)^2 = 0.553 for a triangle.
        EXPECT_NEAR(box, 0.2 + 0.6 * 0.527, 0.02) << method;
        EXPECT_NEAR(triangle, 0.2 + 0.6 * 0.553, 0.02) << method;
        EXPECT_GT(triangle, box) << method;
        EXPECT_NEAR(at(first_half, method), 0.8, 0.02) << method;
    }
    not_blurred(frame, {"--shutter-curve", in("missing.txt")}, ExitCode::invalid_input, "missing.txt");
    not_blurred(frame, {"--shutter-curve", in(".")}, ExitCode::invalid_input, "");
    not_blurred(frame, {"--shutter-curve", write("bad.txt", "0 x\n")}, ExitCode::invalid_input, "bad.txt:1");
    not_blurred(frame, {"--shutter-curve", write("empty.txt", "")}, ExitCode::invalid_input, "empty.txt");
    not_blurred(frame, {"--shutter-curve", write("dark.txt", "0 0\n1 0\n")}, ExitCode::invalid_input,
                "dark.txt");
    not_blurred(frame, {"--shutter-curve", write("nan.txt", "0 nan\n1 1\n")}, ExitCode::invalid_input,
                "nan.txt");
}

TEST_F(MotionblurCommand, PathsInsteadOfTheFilesMotion) {
    const std::string frame = moving_plate();
    const std::string down =
        write("down.toml",
              "[[path]]\nobjects = [\"plate\"]\nknots = [{ time_s = 0, at_px = [0, 0] }, "
              "{ time_s = 1, at_px = [0, 7] }]\n");
    json j = blurred(frame, {"--paths", down, "--shutter", "0:1"});
    EXPECT_NEAR(j["objects"][0]["move_px"], 7, 1e-9);
    j = blurred(frame, {"--paths", POSTLENS_SAMPLES "/paths/example.toml", "--shutter", "0:1"}, 3);
    const std::string wall_moves =
        write("wall.toml",
              "[[path]]\nids = [1]\nkeys = [{ time_s = 0 }, { time_s = 1, translate_m = [0.1, 0, 0] }]\n");
    j = blurred(frame, {"--paths", wall_moves, "--shutter", "0:1"});
    EXPECT_EQ(j["objects"].size(), 2U);
    struct Case {
        const char* name;
        std::string text;
        const char* part;
    };
    const std::vector<Case> cases{
        {"unknown.toml", "[[path]]\nids = [9]\nknots = [{ time_s = 0, at_px = [0, 0] }]\n",
         "no such id (got 9"},
        {"name.toml", "[[path]]\nobjects = [\"plait\"]\nknots = [{ time_s = 0, at_px = [0, 0] }]\n", "plate"},
        {"order.toml",
         "[[path]]\nids = [2]\nknots = [{ time_s = 1, at_px = [0, 0] }, { time_s = 0, at_px = [1, 0] }]\n",
         "order.toml:3"},
        {"keys.toml", "[[path]]\nids = [2]\nkeys = [{ time_s = 1 }, { time_s = 1, scale = 2 }]\n",
         "keys.toml:3"},
        {"nan.toml", "[[path]]\nids = [2]\nknots = [{ time_s = nan, at_px = [0, 0] }]\n", "nan.toml:3"},
        {"inf.toml", "[[path]]\nids = [2]\nknots = [{ time_s = 0, at_px = [inf, 0] }]\n", "inf.toml:3"},
        {"flat.toml", "[[path]]\nids = [2]\nkeys = [{ time_s = 0, scale = 0 }]\n", "flat.toml:3"},
        {"twice.toml",
         "[[path]]\nids = [2]\nkeys = [{ time_s = 0 }]\n[[path]]\nobjects = [\"plate\"]\nkeys = [{ time_s = "
         "0 }]\n",
         "twice"},
        {"zero.toml", "[[path]]\nids = [0]\nkeys = [{ time_s = 0 }]\n", "zero.toml:2"},
        {"nothing.toml", "", "no paths"},
        {"syntax.toml", "[[path]\n", "syntax.toml:1"}};
    for (const Case& c : cases)
        not_blurred(frame, {"--paths", write(c.name, c.text), "--shutter", "0:1"}, ExitCode::invalid_input,
                    c.part);
    not_blurred(frame, {"--paths", in("missing.toml")}, ExitCode::invalid_input, "missing.toml");
    not_blurred(frame, {"--paths", in(".")}, ExitCode::invalid_input, "");
    not_blurred(frame, {"--paths", frame}, ExitCode::invalid_input, "a.exr");
}

std::string many(const char* kind, int count, const std::function<std::string(int)>& item) {
    std::string text = std::string("[[path]]\nids = [2]\n") + kind + " = [\n";
    for (int i = 0; i < count; ++i)
        text += "{ time_s = " + std::to_string(i * (1.0 / count)) + item(i) + " },\n";
    return text + "]\n";
}

TEST_F(MotionblurCommand, LongPaths) {
    const std::string frame = moving_plate();
    const auto knot = [](int i) { return ", at_px = [" + std::to_string(12 * std::sin(i * 1e-3)) + ", 0]"; };
    const auto key = [](int i) {
        return ", translate_m = [" + std::to_string(0.5 * std::sin(i * 1e-3)) + ", 0, 0]";
    };
    // A linear search for each key would take minutes.
    for (const std::string& text : {many("knots", 100'000, knot), many("keys", 100'000, key)}) {
        const Outcome r =
            blur(frame, {"--paths", write("long.toml", text), "--shutter", "0:1", "--method", "convolve"},
                 "timeout 100 ");
        EXPECT_EQ(r.exit_code, 0) << r.err;
    }
    not_blurred(frame, {"--paths", write("long.toml", many("knots", 100'001, knot)), "--shutter", "0:1"},
                ExitCode::invalid_input, "'knots' has too many (got 100001; expected at most 100000)");
}

TEST_F(MotionblurCommand, PathsFarTooLongAreRefused) {
    const std::string frame = moving_plate();
    const std::string far = write("far.toml",
                                  "[[path]]\nids = [2]\nknots = [{ time_s = 0, at_px = [0, 0] }, "
                                  "{ time_s = 1, at_px = [1e12, 0] }]\n");
    const Outcome r =
        blur(frame, {"--paths", far, "--shutter", "0:1", "--method", "convolve"}, "timeout 100 ");
    EXPECT_TRUE(r.exit_code == 0 || r.exit_code == 2 || r.exit_code == 3) << r.exit_code << r.err;
    EXPECT_LE(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
}

TEST_F(MotionblurCommand, FittedPathsSaySo) {
    const std::string frame = moving_plate();
    const auto knot = [](int i) {
        return ", at_px = [" + std::to_string(20 * std::cos(i * 0.01)) + ", " +
               std::to_string(9 * std::sin(i * 0.01)) + "]";
    };
    const std::string track = write("track.toml", many("knots", 300, knot));
    const json j = blurred(frame, {"--paths", track, "--fit-paths", "0.2", "--shutter", "0:1"});
    EXPECT_GT(j["objects"][0]["path_points"], 100);
    EXPECT_LT(j["objects"][0]["fitted_knots"], 10);
    EXPECT_LE(j["objects"][0]["fit_error_px"], 0.2);
    EXPECT_NE(blur(frame, {"--paths", track, "--fit-paths", "0.2", "--shutter", "0:1"})
                  .out.find("points fitted by"),
              std::string::npos);
    for (const char* px : {"0", "-1", "nan", "inf", "x", ""})
        not_blurred(frame, {std::string("--fit-paths=") + px}, ExitCode::wrong_arguments, "--fit-paths");
}

TEST_F(MotionblurCommand, MethodsAndViews) {
    const std::string frame = moving_plate();
    const json j = blurred(frame, {"--method", "lightfield", "--views", "16"});
    EXPECT_EQ(j["method"], "lightfield");
    EXPECT_EQ(j["views"], 16);
    EXPECT_EQ(j["objects"][0]["reason"], "asked for");
    for (const char* views : {"1", "3", "4096"})
        EXPECT_EQ(blurred(frame, {"--method", "lightfield", "--views", views})["views"], std::stoi(views));
    for (const char* views : {"0", "-1", "4097", "2.5", "x", "", "99999999999"})
        not_blurred(frame, {std::string("--views=") + views}, ExitCode::wrong_arguments, "--views");
    for (const char* method : {"scatter", "", "CONVOLVE "})
        not_blurred(frame, {std::string("--method=") + method}, ExitCode::wrong_arguments, "--method");
}

TEST_F(MotionblurCommand, StrictIsSixWhereTheFileDoesNotSuffice) {
    const std::string frame = moving_plate();
    EXPECT_EQ(blur(frame, {"--shutter", "0:1", "--strict"}).exit_code, 0);
    const json j = blurred(frame, {"--shutter", "0:1.5", "--strict"}, 6);
    EXPECT_TRUE(warns(j, "insufficient"));
    EXPECT_FALSE(blurred(frame, {"--shutter", "0:1.5"}).empty());
    const std::string bare = traced("bare", std::string(camera) + materials + wall + plate);
    const json u = blurred(bare, {"--shutter", "0:1", "--strict"}, 6);
    EXPECT_TRUE(warns(u, "uncovered"));
    for (const json& w : u.at("warnings")) {
        EXPECT_TRUE(w.at("share").is_number());
        EXPECT_FALSE(w.at("text").get<std::string>().empty());
    }
    EXPECT_GT(picture().rgb.size(), 0U);  // the image is written nevertheless
}

TEST_F(MotionblurCommand, UnreadableInputIsThree) {
    const std::string frame = moving_plate();
    not_blurred(in("none.exr"), {}, ExitCode::invalid_input, "none.exr");
    not_blurred(in("."), {}, ExitCode::invalid_input, "");
    not_blurred("/dev/null", {}, ExitCode::invalid_input, "/dev/null");
    not_blurred(in("a.toml"), {}, ExitCode::invalid_input, "a.toml");
    EXPECT_EQ(run({"image", frame, "-o", in("plain.exr"), "--quiet"}).exit_code, 0);
    // A flat image is only accepted with motion vectors.
    not_blurred(in("plain.exr"), {"--shutter", "0:1"}, ExitCode::invalid_input, "plain.exr");
    const std::string whole = bytes_of(frame);
    for (const double share : {0.0, 0.01, 0.3, 0.7, 0.99}) {
        write("cut.exr",
              whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
        not_blurred(in("cut.exr"), {"--shutter", "0:1"}, ExitCode::invalid_input, "cut.exr");
    }
}

TEST_F(MotionblurCommand, UnwritableOutputIsFourAndLeavesNothing) {
    const std::string frame = moving_plate();
    const std::size_t before = folder_.file_count();
    for (const auto& [path, code] :
         {std::pair(in("no/such/o.exr"), 4), {in("o.xyz"), 2}, {in("o"), 2}, {in("."), 2}}) {
        const Outcome r = run({"motionblur", frame, "-o", path});
        EXPECT_EQ(r.exit_code, code) << path << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
        EXPECT_EQ(folder_.file_count(), before) << path;
    }
    std::filesystem::create_directory(in("folder.exr"));
    EXPECT_EQ(run({"motionblur", frame, "-o", in("folder.exr")}).exit_code, 4);
    // Simulates a full disk. An existing file must stay unchanged.
    write("old.exr", "as it was");
    const Outcome full = run({"motionblur", frame, "-o", in("old.exr")}, "ulimit -f 2; ");
    EXPECT_EQ(full.exit_code, 4) << full.err;
    EXPECT_EQ(std::count(full.err.begin(), full.err.end(), '\n'), 1) << full.err;
    EXPECT_EQ(bytes_of(in("old.exr")), "as it was");
    EXPECT_EQ(folder_.file_count(), before + 1);
}

TEST_F(MotionblurCommand, ThePictureDoesNotReplaceItsOwnInput) {
    const std::string frame = moving_plate(), before = bytes_of(frame);
    refused({"motionblur", frame, "-o", frame, "--shutter", "0:1"}, ExitCode::wrong_arguments,
            "would overwrite the input FRAME");
    EXPECT_EQ(bytes_of(frame), before);
}

TEST_F(MotionblurCommand, AnOrthographicCamera) {
    const std::string frame = traced("ortho",
                                     std::string("[scene]\nambient_light = 0\n[[camera]]\nprojection = "
                                                 "\"orthographic\"\northographic_width_m = 4\n") +
                                         materials + wall + plate,
                                     {"--for-shutter", "0:1"});
    for (const char* method : {"convolve", "lightfield", "auto"}) {
        const json j = blurred(frame, {"--shutter", "0:1", "--method", method});
        EXPECT_NEAR(j["objects"][0]["move_px"], 16, 1e-3) << method;  // 1 m of 4 m on 64 px
        // The plate moves from columns [16, 32) to [32, 48).
        EXPECT_NEAR(picture().pixel(31, 18)[0], 0.2 + 0.6 * (1 - 0.5 / 16), 0.01) << method;
        EXPECT_NEAR(picture().pixel(24, 18)[0], 0.2 + 0.6 * 8.5 / 16, 0.01) << method;
        EXPECT_NEAR(picture().pixel(10, 18)[0], 0.2, 1e-6) << method;
    }
    for (const char* method : {"lightfield", "auto"}) {
        refused({"motionblur", frame, "-o", in("rays.exr"), "--shutter", "0:1", "--method", method, "--scene",
                 in("ortho.toml")},
                ExitCode::wrong_arguments,
                "--scene: rays and views need a perspective camera (got an orthographic sample file)");
    }
}

TEST_F(MotionblurCommand, NothingBeforeTheCamera) {
    // `trace` rejects a scene without objects, but the camera may see none of them.
    const std::string behind =
        "[[object]]\nname = \"behind\"\nshape = \"sphere\"\nmaterial = \"m\"\ncentre_m = [0, 0, 9]\nradius_m "
        "= 1\n"
        "keys = [{ time_s = 0 }, { time_s = 1, translate_m = [0, 1, 0] }]\n";
    const std::string frame = traced("void", std::string(camera) + "exposure_s = 1\n" + materials + behind);
    for (const char* method : {"convolve", "lightfield", "auto"}) {
        const json j = blurred(frame, {"--method", method});
        EXPECT_TRUE(j["objects"].empty());
        EXPECT_EQ(j["touched_share"], 0);
    }
    // With a rotating camera, only the background moves.
    const std::string turning =
        traced("turning",
               std::string(camera) +
                   "exposure_s = 1\nkeys = [{ time_s = 0 }, { time_s = 1, rotate_degrees = 20, rotate_axis = "
                   "[0, 1, 0] }]\n" +
                   materials + behind);
    for (const char* method : {"convolve", "lightfield", "auto"})
        EXPECT_EQ(blurred(turning, {"--method", method})["objects"][0]["name"], "background") << method;
}

TEST_F(MotionblurCommand, WhatPassesTheCameraNeedsALightField) {
    const std::string passing =
        "[[object]]\nname = \"ball\"\nshape = \"sphere\"\nmaterial = \"m\"\ncentre_m = [0.3, 0, "
        "-3]\nradius_m = 0.5\n"
        "keys = [{ time_s = 0 }, { time_s = 1, translate_m = [0, 0, 5] }]\n";
    const std::string frame =
        traced("passing", std::string(camera) + materials + wall + passing, {"--for-shutter", "0:1"});
    not_blurred(frame, {"--shutter", "0:1", "--method", "convolve"}, ExitCode::wrong_arguments,
                "passes the camera");
    const json j = blurred(frame, {"--shutter", "0:1"});
    EXPECT_EQ(j["objects"][0]["method"], "lightfield");
    EXPECT_EQ(j["objects"][0]["reason"], "passes the camera");
    for (const float v : picture().rgb) EXPECT_TRUE(v >= 0.19F && v <= 0.81F) << v;
}

TEST_F(MotionblurCommand, WhatComesInAfterTheFramesInstantIsLeftOutByConvolveAlone) {
    std::string entering = plate;
    entering.replace(entering.find("corner_m = [-1,"), 15, "corner_m = [-4,");
    entering.replace(entering.find("translate_m = [1,"), 17, "translate_m = [4,");
    const std::string frame = traced("entering", std::string(camera) + materials + wall + entering,
                                     {"--for-shutter", "0:1", "--keys", "3"});
    const json j = blurred(frame, {"--shutter", "0:1", "--method", "convolve", "--strict"}, 6);
    EXPECT_TRUE(warns(j, "left_out"));
    EXPECT_EQ(j["objects"][0]["method"], "none");
    EXPECT_NEAR(picture().pixel(20, 18)[0], 0.2, 1e-6);
    const json whole = blurred(frame, {"--shutter", "0:1"});
    EXPECT_FALSE(warns(whole, "left_out"));
    EXPECT_EQ(whole["objects"][0]["method"], "lightfield");
    EXPECT_GT(picture().pixel(20, 18)[0], 0.25);
}

TEST_F(MotionblurCommand, IdsUpToTheLargest) {
    constexpr std::uint32_t largest = 0xFFFFFFFFU;
    std::mt19937 random(1);
    SampleHeader h = full_header(40, 30, 2, {});
    h.time_s = 0;
    h.exposure_s = 1;
    h.lights_move = false;
    h.motion = {};
    h.object_names = {{1, "wall"}, {largest - 1, "left"}, {largest, "right"}};
    h.moving_ids = {largest - 1, largest};
    for (const std::uint32_t id : h.moving_ids) {
        h.motion.objects[id] = {
            {{.time_s = 0}, {.time_s = 1, .translation = {id == largest ? 2 : 0, 1, 0}}}, {0, 0, -5}, 2};
    }
    RecordBand band = random_frame(random, h, {});
    for (Record& r : band.records) {
        r.id = r.x < 12 ? largest - 1 : r.x < 25 ? largest : 1;
        r.z = r.id == 1 ? 2000 : 1000;
        r.w = Mat2::isotropic(1 / r.z);
    }
    SampleFileWriter writer(in("large.exr"), h, RecordCompression::rle);
    writer.write(band);
    writer.finish();
    for (const char* method : {"convolve", "lightfield"}) {
        const json j = blurred(in("large.exr"), {"--method", method});
        ASSERT_EQ(j["objects"].size(), 2U);
        EXPECT_EQ(j["objects"][0]["id"], largest - 1);
        EXPECT_EQ(j["objects"][1]["id"], largest);
        EXPECT_EQ(j["objects"][1]["name"], "right");
        EXPECT_GT(j["objects"][1]["move_px"], j["objects"][0]["move_px"]);
    }
}

TEST_F(MotionblurCommand, MovingLightsAreSaid) {
    const std::string lit =
        std::string(
            "[scene]\nambient_light = 0\n[[camera]]\n[[light]]\nkind = \"point\"\nposition_m = [0, 3, -2]\n"
            "keys = [{ time_s = 0 }, { time_s = 1, translate_m = [1, 0, 0] }]\n"
            "[[material]]\nname = \"w\"\n") +
        wall;
    const std::string frame = traced("lit", lit, {"--for-shutter", "0:1", "--keys", "2"});
    // Two recorded instants, which include the light's motion, are blended without a warning.
    EXPECT_FALSE(warns(blurred(frame, {"--shutter", "0:1"}), "light"));
    const std::string one = traced("one", lit, {"--for-shutter", "0:1"});
    EXPECT_TRUE(warns(blurred(one, {"--shutter", "0:1"}), "light"));
    EXPECT_FALSE(warns(blurred(one, {"--shutter", "2:3"}), "nonsense"));
    // `shoot` reads the same records. With rays, nothing is missing.
    const auto shot = [&](const std::string& file, const Words& options) {
        Words words{"shoot",   file, "-o",        in("shot.exr"), "--json",  "--f-number", "8",
                    "--focus", "3",  "--shutter", "0:1",          "--views", "8"};
        words.insert(words.end(), options.begin(), options.end());
        return run(words);
    };
    EXPECT_TRUE(warns(json::parse(shot(one, {}).out), "light"));
    EXPECT_EQ(shot(one, {"--strict"}).exit_code, 6);
    EXPECT_FALSE(warns(json::parse(shot(frame, {}).out), "light"));
}

TEST_F(MotionblurCommand, SameBitsForAnyNumberOfThreads) {
    const std::string frame = moving_plate();
    for (const char* method : {"convolve", "lightfield"}) {
        (void)blurred(frame, {"--method", method, "--threads", "1"});
        const std::string first = bytes_of(in("out.exr"));
        (void)blurred(frame, {"--method", method, "--threads", "3"});
        EXPECT_TRUE(first == bytes_of(in("out.exr"))) << method;
    }
}

TEST_F(MotionblurCommand, AnInterruptLeavesNothing) {
    const std::string frame =
        traced("long", std::string(camera) + materials + wall + plate, {"--for-shutter", "0:1"}, "640x360");
    const std::size_t before = folder_.file_count();
    const pid_t child = begin({"motionblur", frame, "-o", in("o.exr"), "--shutter", "0:1", "--method",
                               "lightfield", "--views", "4096", "--threads", "1", "--quiet"});
    wait_for_handler(child);
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    ::kill(child, SIGINT);
    const auto asked = std::chrono::steady_clock::now();
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    // It takes one second on an idle machine; other processes may slow it down.
    EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(10));
    EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), 130);
    EXPECT_EQ(folder_.file_count(), before);
}

}  // namespace
}  // namespace postlens::test::motionblur_command_test
