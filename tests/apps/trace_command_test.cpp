// The command `trace` for a shutter: key instants, hidden layers, and their output by `info` and `records`.
#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "records/sample_file.h"
#include "tests/apps/limited.h"
#include "tests/support/command_test.h"

namespace postlens::test::trace_command_test {
namespace {

using nlohmann::json;

class TraceCommand : public CommandTest {
  protected:
    static std::string scene() { return POSTLENS_SAMPLES "/scenes/motion.toml"; }
    Outcome trace(const std::vector<std::string>& options) {
        std::vector<std::string> words{"trace", scene(), "-o", in("a.exr"), "--size", "96x54", "--json"};
        words.insert(words.end(), options.begin(), options.end());
        return run(words);
    }
    json traced(const std::vector<std::string>& options) {
        const Outcome r = trace(options);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return json::parse(r.out);
    }
    json info() { return json::parse(run({"info", in("a.exr"), "--json"}).out); }
};

TEST_F(TraceCommand, KeysAreSaidAndFound) {
    const json t = traced({"--for-shutter", "0:1", "--keys", "3"});
    EXPECT_EQ(t["keys"], 3);
    EXPECT_EQ(t["instants_s"], (json{0.0, 0.5, 1.0}));
    EXPECT_TRUE(t["keys_sweep_degrees"].is_null());
    EXPECT_GT(t["rays"]["hidden"], 0);
    const json i = info();
    EXPECT_EQ(i["keys"], 3);
    EXPECT_EQ(i["key_times_s"], (json{0.5, 1.0}));
    EXPECT_EQ(i["records"], t["records"]);
    EXPECT_EQ(i["sufficient"]["shutter_s"], (json{0.0, 1.0}));
    EXPECT_GT(i["layers"], 1);
    const Outcome text = run({"info", in("a.exr")});
    EXPECT_NE(text.out.find("further instants: 0.5, 1 s"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("shutter open from 0 s to 1 s"), std::string::npos) << text.out;
}

TEST_F(TraceCommand, AutomaticKeysAreSaid) {
    const json t = traced({"--for-shutter", "0:1", "--keys", "auto", "--hidden-layers", "0"});
    // The sweep is that of the box: it rotates by 65 degrees, and its translation adds to this.
    EXPECT_EQ(t["keys"], 6);
    EXPECT_GT(t["keys_sweep_degrees"], 60);
    EXPECT_EQ(t["instants_s"].size(), 6U);
    EXPECT_EQ(info()["layers"], 1);
    const Outcome text = run(
        {"trace", scene(), "-o", in("b.exr"), "--size", "32x18", "--for-shutter", "0:1", "--keys", "auto"});
    EXPECT_NE(text.out.find("6 keys, as something turns by 66"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("recorded at 0, 0.2, 0.4, 0.6, 0.8, 1 s"), std::string::npos) << text.out;
    EXPECT_EQ(traced({"--for-shutter", "0:1", "--keys", "auto", "--for-rays"})["keys"], 4);
}

TEST_F(TraceCommand, WarnsIfMoreKeysWouldShowWhatTurns) {
    const auto warned = [&](const std::vector<std::string>& more) {
        const json warnings = traced(more)["warnings"];
        return std::count_if(warnings.begin(), warnings.end(),
                             [](const json& w) { return w["code"] == "turns"; });
    };
    EXPECT_EQ(warned({"--for-shutter", "0:1"}), 1);
    EXPECT_EQ(warned({"--for-shutter", "0:0.1"}), 0);
    EXPECT_EQ(warned({"--for-shutter", "0:1", "--keys", "auto"}), 0);
    EXPECT_EQ(warned({"--for-shutter", "0:0.4"}), 1);  // some 26 degrees
    EXPECT_EQ(warned({"--for-shutter", "0:0.4", "--for-rays"}), 0);
    EXPECT_EQ(warned({}), 0);
    EXPECT_EQ(warned({"--for-shutter", "0:1", "--keys", "5"}), 1);  // four steps of 16.5 degrees
    EXPECT_EQ(warned({"--for-shutter", "0:1", "--keys", "6"}), 0);
    const std::string text = traced({"--for-shutter", "0:1"})["warnings"][0]["text"];
    EXPECT_EQ(text,
              "an object turns by 66.1 degrees relative to the camera while the shutter is open, but only "
              "one instant is "
              "recorded (expected --keys auto)");
}

TEST_F(TraceCommand, WarnsOfWhatNoInstantShows) {
    std::ofstream(in("passes.toml")) << R"(
[[camera]]
focal_length_mm = 50
[[object]]
shape = "sphere"
radius_m = 0.1
keys = [{ time_s = 0, translate_m = [9, 0, -4] }, { time_s = 1, translate_m = [-9, 0, -4] }]
)";
    const auto warned = [&](const char* keys) {
        const Outcome r = run({"trace", in("passes.toml"), "-o", in("p.exr"), "--size", "32x18",
                               "--for-shutter", "0:1", "--keys", keys, "--json"});
        const json warnings = json::parse(r.out)["warnings"];
        return std::any_of(warnings.begin(), warnings.end(),
                           [](const json& w) { return w["code"] == "visit"; });
    };
    EXPECT_TRUE(warned("1"));
    EXPECT_TRUE(warned("2"));
    EXPECT_FALSE(warned("3"));  // the middle
    EXPECT_FALSE(warned("auto"));
}

TEST_F(TraceCommand, WarnsOfLightThatTheKeysDoNotFollow) {
    std::ofstream(in("turns.toml")) << R"(
[[camera]]
focal_length_mm = 50
[[light]]
kind = "directional"
direction = [0, 0, -1]
keys = [{ time_s = 0 }, { time_s = 0.5, rotate_degrees = 80, rotate_axis = [0, 1, 0] }, { time_s = 1 }]
[[object]]
shape = "rectangle"
corner_m = [-9, -9, -4]
edge_u_m = [18, 0, 0]
edge_v_m = [0, 18, 0]
)";
    const auto warned = [&](const char* keys) {
        const Outcome r = run({"trace", in("turns.toml"), "-o", in("t.exr"), "--size", "32x18",
                               "--for-shutter", "0:1", "--keys", keys, "--json"});
        const json warnings = json::parse(r.out)["warnings"];
        return std::any_of(warnings.begin(), warnings.end(),
                           [](const json& w) { return w["code"] == "light"; });
    };
    EXPECT_TRUE(warned("2"));  // the light is the same at both ends
    EXPECT_FALSE(warned("33"));
    EXPECT_FALSE(warned("auto"));
    EXPECT_FALSE(warned("1"));  // motionblur warns
}

TEST_F(TraceCommand, WithoutAShutterNothingIsAdded) {
    const json t = traced({});
    EXPECT_EQ(t["keys"], 1);
    EXPECT_EQ(t["rays"]["hidden"], 0);
    const json i = info();
    EXPECT_EQ(i["layers"], 1);
    EXPECT_EQ(i["keys"], 1);
    EXPECT_TRUE(i["sufficient"]["shutter_s"].is_null());
    // A fixed number of layers is always allowed.
    EXPECT_GT(traced({"--hidden-layers", "2"})["rays"]["hidden"], 0);
    EXPECT_EQ(info()["layers"], 3);
}

TEST_F(TraceCommand, RecordsShowsHiddenNodesAndKeys) {
    (void)traced({"--for-shutter", "0:1", "--keys", "3"});
    // The ball, 10 px in radius, rolls from 16 px to 27 px along row 15.
    const std::vector<std::string> at{"records", in("a.exr"), "--at", "9,15", "--json"};
    const json now = json::parse(run(at).out);
    EXPECT_EQ(now["time_s"], 0.0);
    const auto layers_at = [](const json& pixel) {
        std::vector<std::pair<int, std::string>> out;
        for (const json& node : pixel["samples"][0]["nodes"]) out.emplace_back(node["layer"], node["name"]);
        return out;
    };
    EXPECT_EQ(layers_at(now), (std::vector<std::pair<int, std::string>>{{0, "rolling ball"}, {1, "wall"}}));
    std::vector<std::string> later = at;
    later.insert(later.end(), {"--key", "2"});
    const json then = json::parse(run(later).out);
    EXPECT_EQ(then["time_s"], 1.0);
    EXPECT_EQ(layers_at(then), (std::vector<std::pair<int, std::string>>{{0, "wall"}}));
    EXPECT_NE(run({"records", in("a.exr"), "--at", "9,15"}).out.find("hidden layer 1"), std::string::npos);
    refused({"records", in("a.exr"), "--at", "9,15", "--key", "3"}, ExitCode::wrong_arguments, "--key");
    refused({"records", in("a.exr"), "--at", "9,15", "--key", "-1"}, ExitCode::wrong_arguments, "--key");
}

TEST_F(TraceCommand, TheVisiblePictureIsTheSame) {
    const std::string plain = in("plain.exr"), shuttered = in("shuttered.exr");
    // Without subdivision, because edges of hidden surfaces would subdivide pixels and change the visible
    // image.
    (void)traced({"--subdivide", "0"});
    EXPECT_EQ(run({"image", in("a.exr"), "-o", plain, "--quiet"}).exit_code, 0);
    const std::vector<std::string> lens{"--f-number", "2.8",     "--focus", "4",
                                        "--method",   "scatter", "--quiet"};
    const auto focused = [&](const std::string& to) {
        std::vector<std::string> words{"focus", in("a.exr"), "-o", to};
        words.insert(words.end(), lens.begin(), lens.end());
        EXPECT_EQ(run(words).exit_code, 0);
    };
    focused(in("plain_lens.exr"));
    (void)traced({"--subdivide", "0", "--for-shutter", "0:1", "--keys", "2"});
    EXPECT_EQ(run({"image", in("a.exr"), "-o", shuttered, "--quiet"}).exit_code, 0);
    focused(in("shuttered_lens.exr"));
    EXPECT_TRUE(bytes_of(plain) == bytes_of(shuttered));
    EXPECT_TRUE(bytes_of(in("plain_lens.exr")) == bytes_of(in("shuttered_lens.exr")));
}

TEST_F(TraceCommand, ALensBringsHiddenLayersAndFinerEdges) {
    const json bare = traced({});
    EXPECT_EQ(info()["subdivide"], 2);
    const json lens = traced({"--for-f-number", "1.4"});
    EXPECT_GT(lens["rays"]["hidden"], 0);
    EXPECT_GT(lens["records"], bare["records"]);
    const json i = info();
    EXPECT_EQ(i["subdivide"], 3);
    EXPECT_GT(i["layers"], 1);
    EXPECT_EQ(i["sufficient"]["f_number"], 1.4);
    EXPECT_NE(run({"info", in("a.exr")}).out.find("suffices for f-numbers from 1.4 on"), std::string::npos);
    // A smaller aperture sees less far past edges.
    EXPECT_LT(traced({"--for-f-number", "5.6"})["records"], lens["records"]);
    // Explicit options override both defaults.
    EXPECT_EQ(traced({"--for-f-number", "1.4", "--hidden-layers", "0"})["rays"]["hidden"], 0);
    EXPECT_EQ(info()["layers"], 1);
    EXPECT_LT(traced({"--for-f-number", "1.4", "--subdivide", "1"})["records"], lens["records"]);
    EXPECT_EQ(info()["subdivide"], 2);  // for narrow objects
    // With a shutter and a lens, hidden surfaces of both are recorded.
    const json shutter = traced({"--for-shutter", "0:1", "--subdivide", "2"});
    const json both = traced({"--for-shutter", "0:1", "--for-f-number", "1.4", "--subdivide", "2"});
    EXPECT_GT(both["records"], shutter["records"]);
    EXPECT_GT(both["records"], traced({"--for-f-number", "1.4", "--subdivide", "2"})["records"]);
}

TEST_F(TraceCommand, FocusSaysWhereTheFileDoesNotSuffice) {
    (void)traced({"--for-f-number", "2", "--for-focus", "4", "--overscan", "auto"});
    const auto focused = [&](const std::vector<std::string>& lens, int exit_code) {
        std::vector<std::string> words{"focus", in("a.exr"), "-o", in("f.exr"), "--strict", "--json"};
        words.insert(words.end(), lens.begin(), lens.end());
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, exit_code) << r.err << r.out;
        std::vector<std::string> codes;
        const json j = json::parse(r.out);
        for (const json& w : j["warnings"]) codes.push_back(w["code"]);
        return std::count(codes.begin(), codes.end(), "insufficient");
    };
    EXPECT_EQ(focused({"--f-number", "2", "--focus", "4"}, 0), 0);
    EXPECT_EQ(focused({"--f-number", "1.9", "--focus", "4"}, 6), 1);
    // The hidden surfaces suffice for every focus distance, and the overscan for circles of confusion as wide
    // as those of --for-focus.
    EXPECT_EQ(focused({"--f-number", "2", "--focus", "5"}, 0), 0);
    EXPECT_EQ(focused({"--f-number", "1.9", "--focus", "5"}, 6), 1);
    // The diameter of the aperture, F / n, determines the warning.
    const double focal_length_mm = info()["focal_length_mm"];
    EXPECT_EQ(
        focused({"--focal-length", std::to_string(focal_length_mm / 2), "--f-number", "1", "--focus", "4"},
                0),
        0);
    EXPECT_EQ(
        focused({"--focal-length", std::to_string(focal_length_mm * 2), "--f-number", "2", "--focus", "4"},
                6),
        1);
}

// Without --method, `focus` selects the usual method for the content of the file, and reports it.
TEST_F(TraceCommand, FocusTakesTheUsualMethodForTheFile) {
    const auto focused = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"focus", in("a.exr"), "-o", in("f.exr"), "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return json::parse(r.out);
    };
    const std::vector<std::string> lens{"--f-number", "2", "--focus", "4"};
    (void)traced({"--max-depth", "1"});
    json j = focused(lens);
    EXPECT_EQ(j["method"], "scatter");
    EXPECT_EQ(j["method_reason"], "as the file has nothing behind what is seen");
    ASSERT_EQ(run({"trace", POSTLENS_SAMPLES "/scenes/still_life.toml", "-o", in("a.exr"), "--size", "96x54",
                   "--quiet"})
                  .exit_code,
              0);
    EXPECT_EQ(focused(lens)["method_reason"], "as the file has mirrors or glass");
    (void)traced({"--for-f-number", "2", "--max-depth", "1"});
    j = focused(lens);
    EXPECT_EQ(j["method"], "layers");
    EXPECT_EQ(j["method_reason"], "as the file has hidden surfaces");
    EXPECT_EQ(focused({"--f-number", "2", "--focus", "4", "--method", "scatter"})["method_reason"], nullptr);
    EXPECT_EQ(focused({"--f-number", "inf", "--focus", "4"})["method"], "pinhole");
    // With a target, `auto` plans the number of views.
    j = focused({"--f-number", "2", "--focus", "4", "--method", "auto", "--target-db", "20"});
    EXPECT_EQ(j["method"], "auto");
    EXPECT_TRUE(j.contains("plan"));
    const Outcome text = run({"focus", in("a.exr"), "-o", in("f.exr"), "--f-number", "2", "--focus", "4"});
    EXPECT_NE(text.out.find("layers, as the file has hidden surfaces"), std::string::npos) << text.out;
}

// Options have the same meaning in all commands: --film-distance sets the view, --focal-length the lens.
TEST_F(TraceCommand, TheFilmDistanceIsTheViewInTraceAndRender) {
    (void)traced({"--film-distance", "85"});
    EXPECT_EQ(info()["film_distance_mm"], 85);
    ASSERT_EQ(run({"image", in("a.exr"), "-o", in("image.exr")}).exit_code, 0);
    const json size = info();
    const std::string px =
        std::to_string(size["width"].get<int>()) + "x" + std::to_string(size["height"].get<int>());
    for (const char* distance : {"85", "50"}) {
        const Outcome r = run({"render", scene(), "-o", in("r.exr"), "--spp", "64", "--size", px,
                               "--f-number", "inf", "--film-distance", distance});
        ASSERT_EQ(r.exit_code, 0) << r.err;
        const Outcome c = run({"compare", in("image.exr"), in("r.exr"), "--json"});
        EXPECT_EQ(json::parse(c.out)["psnr_db"] > 30, std::string(distance) == "85") << distance;
    }
}

TEST_F(TraceCommand, LayersInMirrorsDisturbNoReader) {
    const std::string still_life = POSTLENS_SAMPLES "/scenes/still_life.toml";
    const std::string frame = in("a.exr");
    const Outcome r =
        run({"trace", still_life, "-o", frame, "--size", "64x36", "--for-f-number", "1.4", "--json"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    EXPECT_GT(info()["layers"], 1);
    const SampleFileReader file(frame);
    RecordBand band;
    file.read(file.y_begin(), file.y_end(), band);
    const Record* found = nullptr;
    for (const Record& record : band.records) {
        const bool hidden = record.layer == 1 && record.path.bits() != 0;
        if (hidden && record.x < 64 && record.y < 36) found = &record;
    }
    ASSERT_NE(found, nullptr);
    const Outcome shown =
        run({"records", frame, "--at", std::to_string(found->x) + "," + std::to_string(found->y)});
    EXPECT_EQ(shown.exit_code, 0) << shown.err;
    EXPECT_NE(shown.out.find("hidden layer 1"), std::string::npos) << shown.out;
    EXPECT_EQ(run({"image", frame, "-o", in("p.exr"), "--quiet"}).exit_code, 0);
    const Outcome focused = run({"focus", frame, "-o", in("f.exr"), "--json"});
    EXPECT_EQ(focused.exit_code, 0);
    // The mirror ball and the glass ball have nonlinear W.
    EXPECT_GT(json::parse(r.out)["rays"]["lens"], 0);
    EXPECT_EQ(info()["refocus_bends"], true);
    EXPECT_NE(focused.out.find("nonlinear"), std::string::npos) << focused.out;
    // Rays replace what W misplaces.
    for (const Words& command : {Words{"focus", frame, "-o", in("f.exr"), "--views", "4"},
                                 Words{"sweep", frame, "-o", in("sweep"), "--views", "4"}}) {
        const Outcome rays = run(command + Words{"--method", "hybrid", "--scene", still_life, "--json"});
        EXPECT_EQ(rays.exit_code, 0) << rays.err;
        EXPECT_EQ(rays.out.find("nonlinear"), std::string::npos) << rays.out;
    }
}

TEST_F(TraceCommand, CoarseRecordsSufficeForRays) {
    const auto records = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"--for-f-number", "1.4", "--for-focus", "4"};
        words.insert(words.end(), more.begin(), more.end());
        const json t = traced(words);
        return std::pair(t["records"].get<std::uint64_t>(), bytes_of(in("a.exr")).size());
    };
    const auto one_level = records({"--subdivide", "1"});
    // Narrow strips of hidden surfaces are not recorded for rays.
    EXPECT_LT(records({"--for-rays"}).first, one_level.first);
    EXPECT_LT(one_level.first, records({}).first);
    EXPECT_EQ(records({"--for-rays", "--hidden-layers", "0"}),
              records({"--subdivide", "1", "--hidden-layers", "0"}));
    // `--subdivide` overrides `--for-rays`.
    EXPECT_EQ(records({"--for-rays", "--hidden-layers", "0", "--subdivide", "2"}),
              records({"--subdivide", "2", "--hidden-layers", "0"}));
    // A plan for rays has one level for every target, and is not short of a target that no records reach.
    const Outcome plan =
        trace({"--for-f-number", "1.4", "--for-focus", "4", "--plan", "--target-db", "80", "--for-rays"});
    EXPECT_EQ(plan.exit_code, 0) << plan.err;
    EXPECT_EQ(json::parse(plan.out)["plan"]["subdivide"], 1);
    const Outcome short_of_it = run({"trace", scene(), "-o", in("a.exr"), "--size", "48x27", "--for-f-number",
                                     "1.4", "--for-focus", "4", "--plan", "--target-db", "80"});
    EXPECT_EQ(short_of_it.exit_code, static_cast<int>(ExitCode::shortfall));
}

TEST_F(TraceCommand, WritesOpenExrAlone) {
    for (const char* name : {"a.png", "a", "a.exr.gz", "a.toml"}) {
        refused({"trace", scene(), "-o", in(name), "--size", "16x9"}, ExitCode::wrong_arguments,
                std::string(name) + ": records are written as OpenEXR (got ending");
    }
    EXPECT_EQ(run({"trace", scene(), "-o", in("a.EXR"), "--size", "16x9"}).exit_code, 0);
}

TEST_F(TraceCommand, TooLargeIsFiveAndSaysHowMuch) {
    // The image alone takes 12 bytes for each of 65536^2 pixels.
    for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{
             {}, {"--force"}, {"--for-f-number", "2", "--for-focus", "4", "--plan"}}) {
        std::vector<std::string> words{"trace", scene(), "-o", in("a.exr"), "--size", "65536x65536"};
        words.insert(words.end(), options.begin(), options.end());
        // The error must come before any such memory is allocated.
        const Outcome r = run(words, ten_seconds_and_a_gibibyte());
        EXPECT_EQ(r.exit_code, static_cast<int>(ExitCode::out_of_memory)) << r.err;
        EXPECT_NE(r.err.find("a.exr: a trace of 65536x65536 px needs "), std::string::npos) << r.err;
        EXPECT_NE(r.err.find(" MB of memory"), std::string::npos) << r.err;
    }
}

TEST_F(TraceCommand, WhatCannotBeIsRefused) {
    struct Case {
        std::vector<std::string> options;
        const char* part;
    };
    const std::vector<Case> cases{
        {{"--for-shutter", "0:1", "--keys", "0"}, "--keys: out of range (got 0; expected 1 to 64)"},
        {{"--for-shutter", "0:1", "--keys", "65"}, "--keys: out of range (got 65; expected 1 to 64)"},
        {{"--for-shutter", "0:1", "--keys", "-1"}, "--keys: out of range (got -1; expected 1 to 64)"},
        {{"--for-shutter", "0:1", "--keys", "x"}, "--keys: not a whole number (got x"},
        {{"--for-shutter", "0:1", "--keys", "2.5"}, "--keys: not a whole number"},
        {{"--for-shutter", "0:1", "--keys", ""}, "--keys: not a whole number (got nothing"},
        {{"--keys", "2"}, "--keys: needs to know the shutter (expected --for-shutter)"},
        {{"--keys", "auto"}, "--keys: needs to know the shutter (expected --for-shutter)"},
        {{"--for-shutter", "1:0"}, "--for-shutter: closes before it opens (got 1:0; expected OPEN <= CLOSE)"},
        {{"--for-shutter", "nan:1"}, "--for-shutter: not two instants (got nan:1"},
        {{"--for-shutter", "0:inf"}, "--for-shutter: not two instants"},
        {{"--for-shutter", "0.5"}, "--for-shutter: not two instants"},
        {{"--hidden-layers", "auto"},
         "--hidden-layers auto: needs to know the lens or the shutter (expected --for-f-number or "
         "--for-shutter)"},
        {{"--for-f-number", "0"}, "--for-f-number: out of range (got 0; expected more than 0)"},
        {{"--for-f-number", "inf"}, "--for-f-number: not a number (got inf"},
        {{"--for-focus", "0"}, "--for-focus: out of range (got 0; expected more than 0"},
        {{"--for-focus", "-2"}, "--for-focus: out of range (got -2; expected more than 0"},
        {{"--for-focus", "nan"}, "--for-focus: not a number (got nan"},
        {{"--hidden-layers", "17"}, "--hidden-layers: out of range (got 17; expected 0 to 16)"},
        {{"--hidden-layers", "-1"}, "--hidden-layers: out of range (got -1; expected 0 to 16)"},
        {{"--hidden-layers", "some"}, "--hidden-layers: not a whole number (got some"},
        {{"--overscan", "auto"}, "--overscan auto: needs to know the lens or the shutter"},
        {{"--overscan", "auto", "--for-f-number", "2"},
         "--overscan auto: needs to know the lens or the shutter"},
    };
    for (const Case& c : cases) {
        std::vector<std::string> words{"trace", scene(), "-o", in("a.exr"), "--size", "16x9"};
        words.insert(words.end(), c.options.begin(), c.options.end());
        refused(words, ExitCode::wrong_arguments, c.part);
    }
}

}  // namespace
}  // namespace postlens::test::trace_command_test
