// Images of other programs on the command line: focus, image, info, and damaged files.
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pictures/foreign/foreign_picture.h"
#include "tests/apps/limited.h"
#include "tests/support/command_test.h"
#include "tests/support/flat_exr.h"

namespace postlens::test::foreign_command_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string data_folder = POSTLENS_TEST_DATA "/exr/";

/// Writes an image with depth: a half-plane at 1 m in front of a wall at 4 m.
void write_half_plane(const std::string& path, bool with_depth = true) {
    std::vector<std::string> channels{"R", "G", "B"};
    if (with_depth) channels.emplace_back("Z");
    write_flat_exr(path, channels, 48, 24, [&](int x, int) {
        const bool near = x >= 24;
        std::vector<float> out{near ? 0.8F : 0.1F, 0.5F, near ? 0.1F : 0.8F};
        if (with_depth) out.push_back(near ? 1 : 4);
        return out;
    });
}

class ForeignCommand : public CommandTest {
  protected:
    json done(const std::vector<std::string>& words) {
        std::vector<std::string> all = words;
        all.emplace_back("--json");
        const Outcome r = run(all);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return r.exit_code == 0 ? json::parse(r.out) : json();
    }
    static int warnings(const json& said, const std::string& code) {
        int count = 0;
        for (const json& w : said.at("warnings")) count += w.at("code") == code ? 1 : 0;
        return count;
    }
};

TEST_F(ForeignCommand, DeepPicturesAreFlattenedAsAnotherProgramDoes) {
    for (const std::string name : {"deep_object_ids", "deep_alpha"}) {
        const ForeignPicture theirs = read_foreign_picture(data_folder + name + ".flattened.exr", {}, {});
        const Image wanted = theirs.flattened();
        done({"image", data_folder + name + ".exr", "-o", in("image.exr")});
        done({"focus", data_folder + name + ".exr", "-o", in("focus.exr"), "--method", "pinhole"});
        for (const char* made : {"image.exr", "focus.exr"}) {
            const Image mine = read_foreign_picture(in(made), {}, {}).flattened();
            ASSERT_EQ(mine.alpha.size(), wanted.alpha.size()) << name << " " << made;
            // The written values are floats; the stored samples are halves.
            for (std::size_t i = 0; i < mine.alpha.size(); ++i) {
                ASSERT_NEAR(mine.alpha[i], wanted.alpha[i], 1e-3);
                for (std::size_t c = 0; c < 3; ++c)
                    ASSERT_NEAR(mine.rgb[3 * i + c], wanted.rgb[3 * i + c], 1e-3);
            }
        }
    }
}

TEST_F(ForeignCommand, EveryDefaultIsSaidAloud) {
    write_half_plane(in("a.exr"));
    const std::vector<std::string> bare{"focus",      in("a.exr"), "-o",      in("o.exr"),
                                        "--f-number", "2",         "--focus", "4"};
    const json said = done(bare);
    EXPECT_EQ(warnings(said, "assumed"), 4);  // film width and distance, unit and direction of depth
    EXPECT_EQ(said.at("film_distance_mm"), 50);
    std::vector<std::string> full = bare;
    for (const char* word :
         {"--film-width", "24", "--focal-length", "35", "--metres-per-unit", "0.5", "--z", "axial"})
        full.emplace_back(word);
    const json told = done(full);
    EXPECT_EQ(warnings(told, "assumed"), 0);
    EXPECT_EQ(told.at("film_distance_mm"), 35);
    EXPECT_EQ(told.at("focal_length_mm"), 35);
    // The CoC is (d / pitch) (F / n) |1/s - 1/z'| for the half-plane at 0.5 m.
    EXPECT_NEAR(told.at("largest_coc_px").get<double>(), 35 / (24.0 / 48) * (0.035 / 2) * (1 / 0.5 - 1 / 4.0),
                1e-5);
    full.emplace_back("--strict");
    // Warnings about surfaces behind the half-plane and beyond the frame may remain.
    EXPECT_EQ(run(full).exit_code, told.at("warnings").empty() ? 0 : 6);
    std::vector<std::string> strict = bare;
    strict.emplace_back("--strict");
    EXPECT_EQ(run(strict).exit_code, 6);
    // --focus-at focuses on the depth at a pixel.
    EXPECT_EQ(done({"focus", in("a.exr"), "-o", in("o.exr"), "--f-number", "2", "--focus-at", "40,10"})
                  .at("focus_m"),
              1);
    // Without depths everything is taken as infinitely far, with a warning.
    write_half_plane(in("flat.exr"), false);
    EXPECT_EQ(warnings(done({"focus", in("flat.exr"), "-o", in("o.exr"), "--f-number", "2", "--focus", "4"}),
                       "assumed"),
              5);
}

TEST_F(ForeignCommand, ScatterAndLayersBlurWithAnyAperture) {
    write_half_plane(in("a.exr"));
    for (const std::string method : {"scatter", "layers"}) {
        for (const std::string impulse : {"disc", "polygon:5", "diffraction:550"}) {
            const json said = done({"focus", in("a.exr"), "-o", in("o.exr"), "--f-number", "1", "--focus",
                                    "4", "--method", method, "--impulse", impulse});
            EXPECT_EQ(said.at("method"), method);
            const Image image = read_image(in("o.exr"));
            EXPECT_NEAR(image.pixel(2, 12)[0], 0.1F, 2e-3) << impulse;   // far from the edge
            EXPECT_NEAR(image.pixel(24, 12)[1], 0.5F, 2e-3) << impulse;  // a uniform channel stays uniform
            EXPECT_GT(image.pixel(23, 12)[0], 0.12F) << impulse;         // the edge is soft: 2.5 px wide
        }
    }
}

TEST_F(ForeignCommand, LayersAreTheUsualMethod) {
    write_half_plane(in("a.exr"));
    const json said = done({"focus", in("a.exr"), "-o", in("o.exr"), "--f-number", "1", "--focus", "4"});
    EXPECT_EQ(said.at("method"), "layers");
    EXPECT_EQ(said.at("method_reason"), "as it is a picture of another program");
}

TEST_F(ForeignCommand, SaysWhatIsInAFile) {
    const json said = done({"info", data_folder + "deep_alpha.exr"});
    EXPECT_EQ(said.at("kind"), "image");
    EXPECT_EQ(said.at("deep"), true);
    EXPECT_EQ(said.at("width"), 160);
    EXPECT_EQ(said.at("colour").at("depth"), "Z");
    EXPECT_NEAR(said.at("film_distance_mm").get<double>(), 43.4558, 1e-3);
}

TEST_F(ForeignCommand, EdgesAreTakenApartByACryptomatte) {
    const std::string input = data_folder + "cryptomatte.exr";
    const std::vector<std::string> words{"focus", input,     "-o", in("o.exr"), "--f-number",
                                         "1.4",   "--focus", "5",  "--method",  "layers"};
    const json said = done(words);
    EXPECT_EQ(said.at("channels").at("cryptomatte"), "CryptoObject");
    EXPECT_GT(said.at("unmixed").get<int>(), 10);
    const auto with = [&](const std::string& ids) {
        std::vector<std::string> all = words;
        all.insert(all.end(), {"--ids", ids});
        return done(all);
    };
    EXPECT_EQ(with("none").at("unmixed"), 0);
    EXPECT_GE(said.at("samples").get<int>(),
              with("none").at("samples").get<int>() + said.at("unmixed").get<int>());
    EXPECT_EQ(with("CryptoObject00.R").at("channels").at("id"), "CryptoObject00.R");
    const json info = done({"info", input});
    EXPECT_EQ(info.at("cryptomattes").at(0).at("ranks"), 4);
    EXPECT_EQ(info.at("cryptomattes").at(0).at("names"), 1);
}

TEST_F(ForeignCommand, ObjectsArePickedOutByName) {
    const std::string input = data_folder + "cryptomatte.exr";
    const json info = done({"info", input});
    const auto with = [&](std::vector<std::string> more, const std::string& out) {
        std::vector<std::string> words{"focus", input,     "-o", in(out),    "--f-number",
                                       "1.4",   "--focus", "5",  "--method", "layers"};
        words.insert(words.end(), more.begin(), more.end());
        return done(words);
    };
    with({}, "plain.exr");
    const auto refusal =
        run({"focus", input, "-o", in("o.exr"), "--f-number", "1.4", "--focus", "5", "--holdout", "nobody"});
    EXPECT_EQ(refusal.exit_code, 2);
    const std::size_t at = refusal.err.find("CryptoObject: ");
    ASSERT_NE(at, std::string::npos) << refusal.err;
    std::string name = refusal.err.substr(at + 14);
    name = name.substr(0, name.find_first_of(",)\n"));
    EXPECT_TRUE(with({"--holdout", name}, "holdout.exr").at("has_alpha").get<bool>());
    // A matte leaves everything else to the bit.
    with({"--matte", name}, "matte.exr");
    done({"focus", input, "-o", in("pinhole.exr"), "--method", "pinhole"});
    const Image matte = read_image(in("matte.exr")), pinhole = read_image(in("pinhole.exr")),
                plain = read_image(in("plain.exr"));
    std::size_t as_pinhole = 0, as_plain = 0;
    for (std::size_t i = 0; i < matte.rgb.size(); ++i) {
        as_pinhole += matte.rgb[i] == pinhole.rgb[i] ? 1 : 0;
        as_plain += matte.rgb[i] == plain.rgb[i] ? 1 : 0;
    }
    EXPECT_GT(as_pinhole, matte.rgb.size() / 10);
    EXPECT_LT(as_pinhole, matte.rgb.size());
    EXPECT_GT(as_plain, 0U);
    with({"--passes", "coc,sides,cryptomatte"}, "passes.exr");
    const json made = done({"info", in("passes.exr")});
    const auto channels = made.at("channels").get<std::vector<std::string>>();
    for (const char* channel : {"CoC", "focus.before", "CryptoObject00.R"})
        EXPECT_NE(std::find(channels.begin(), channels.end(), channel), channels.end()) << channel;
    EXPECT_EQ(made.at("cryptomattes").at(0).at("name"), "CryptoObject");
    // Views have an effect on what is measured by them, with any method.
    with({"--passes", "sides", "--views", "8"}, "few.exr");
    EXPECT_EQ(read_image(in("few.exr")).rgb, plain.rgb);
    refused({"focus", input, "-o", in("o.exr"), "--f-number", "1.4", "--focus", "5", "--passes", "coc",
             "--views", "8"},
            ExitCode::wrong_arguments, "--views: not with the method layers");
    refused({"focus", input, "-o", in("o.png"), "--f-number", "1.4", "--focus", "5", "--passes", "coc"},
            ExitCode::wrong_arguments, "passes");
    refused({"focus", input, "-o", in("o.exr"), "--f-number", "1.4", "--focus", "5", "--passes", "depth"},
            ExitCode::wrong_arguments, "depth");
    refused({"focus", input, "-o", in("o.exr"), "--f-number", "1.4", "--focus", "5", "--focus-offset", name},
            ExitCode::wrong_arguments, "OBJECT=M");
}

TEST_F(ForeignCommand, WhatIsBehindAPictureComesToLight) {
    // The half-plane's wall goes on behind it in the second picture.
    write_half_plane(in("front.exr"));
    write_flat_exr(in("behind.exr"), {"R", "G", "B", "Z"}, 48, 24, [](int, int) {
        return std::vector<float>{0.1F, 0.9F, 0.8F, 4};
    });
    const std::vector<std::string> words{
        "focus", in("front.exr"),   "--f-number", "0.5", "--focus", "4", "--film-width",
        "36",    "--film-distance", "50"};
    for (const std::string method : {"layers", "lightfield"}) {
        std::vector<std::string> all = words;
        all.insert(all.end(), {"-o", in(method + ".exr"), "--method", method, "--behind", in("behind.exr")});
        const json said = done(all);
        EXPECT_EQ(warnings(said, "uncovered"), method == "layers" ? 0 : warnings(said, "uncovered"));
        // Just inside the half-plane its blurred edge lets the greener wall through, which it hides.
        const Image image = read_image(in(method + ".exr"));
        EXPECT_GT(image.pixel(25, 12)[1], 0.55F) << method;
        EXPECT_LT(image.pixel(25, 12)[1], 0.9F) << method;
        const std::string text = run(all).out;
        EXPECT_NE(text.find(method == "layers" ? " depths, widest" : ", 64 views, widest"), std::string::npos)
            << text;
    }
}

TEST_F(ForeignCommand, OverscanIsCutOffTheFrame) {
    write_half_plane(in("wide.exr"));
    const json said = done({"focus", in("wide.exr"), "-o", in("o.exr"), "--method", "pinhole", "--overscan",
                            "4", "--film-width", "30"});
    EXPECT_EQ(said.at("film_width_mm"), 30);
    const Image whole = read_image(in("wide.exr")), frame = read_image(in("o.exr"));
    ASSERT_EQ(frame.width, 40);
    ASSERT_EQ(frame.height, 16);
    EXPECT_EQ(frame.pixel(20, 3)[0], whole.pixel(24, 7)[0]);
    EXPECT_EQ(frame.pixel(19, 3)[0], whole.pixel(23, 7)[0]);
    refused({"focus", in("wide.exr"), "-o", in("o.exr"), "--method", "pinhole", "--overscan", "12"},
            ExitCode::wrong_arguments, "--overscan");
}

TEST_F(ForeignCommand, RefusesInOneLine) {
    write_half_plane(in("a.exr"));
    const std::string a = in("a.exr"), o = in("o.exr");
    const auto two = ExitCode::wrong_arguments;
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--method", "hybrid"}, two, "--method");
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--method", "lightfield", "--impulse",
             "diffraction"},
            two, "--impulse");
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--behind", in("none.exr")},
            ExitCode::invalid_input, "none.exr");
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--predict"}, two, "--predict");
    for (const auto& [option, word] :
         {std::pair("--scene", "a.toml"), {"--target-db", "40"}, {"--explain", "e.png"}}) {
        refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", option, word}, two,
                std::string(option) + ": not for a picture of another program");
    }
    for (const auto& [option, word] : {std::pair("--lumens-per-watt", "2"), {"--depth-model", "path"}}) {
        refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", option, word}, two,
                std::string(option) + ": not for a picture of another program (expected a sample file)");
    }
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--method", "lightfield", "--spacing",
             "linear"},
            two, "--spacing: not with the method lightfield (expected scatter or layers)");
    // What is no OpenEXR file is not taken for a sample file.
    std::ofstream(in("a.png")) << "png";
    refused({"focus", in("a.png"), "-o", o, "--film-width", "24"}, ExitCode::invalid_input,
            "a.png: not a postlens sample file (not an OpenEXR file)");
    refused({"image", in("a.png"), "-o", o, "--layer", "x"}, ExitCode::invalid_input,
            "a.png: not a postlens sample file (not an OpenEXR file)");
    // Nor is a file that is absent.
    const std::string none = in("none.exr");
    refused({"focus", none, "-o", o, "--metres-per-unit", "1"}, ExitCode::invalid_input, "none.exr: cannot");
    for (const auto& [option, word] : {std::pair("--metres-per-unit", "1"), {"--layer", "x"}}) {
        refused({"motionblur", none, "-o", o, "--shutter", "0:1", option, word}, ExitCode::invalid_input,
                "none.exr: cannot");
    }
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--film-width", "24", "--salvage"},
            ExitCode::invalid_input, "not a postlens sample file");
    refused({"focus", a, "-o", o, "--focus", "4"}, two, "--f-number");
    refused({"focus", a, "-o", o, "--f-number", "2"}, two, "--focus");
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--z", "x"}, two, "--z");
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus-at", "48,10"}, two,
            "--focus-at: outside the stored pixels (got 48,10; expected 0 <= X < 48, 0 <= Y < 24)");
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--behind-layer", "x"}, two,
            "--behind-layer: of which picture? (got x; expected --behind with it)");
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--film-width", "0"}, two,
            "--film-width");
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--layer", "x"}, ExitCode::invalid_input,
            "no colours in x");
    const std::string frame = in("frame.exr");
    ASSERT_EQ(run({"trace", POSTLENS_SAMPLES "/scenes/ruler.toml", "-o", frame, "--size", "16x9"}).exit_code,
              0);
    refused({"focus", frame, "-o", o, "--f-number", "2", "--focus", "4", "--film-width", "24"}, two,
            "--film-width");
    refused({"focus", frame, "-o", o, "--f-number", "2", "--focus", "4", "--behind", a}, two, "--behind");
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--behind", frame},
            ExitCode::invalid_input, "frame.exr");
    refused({"image", frame, "-o", o, "--layer", "x"}, two, "--layer");
    refused({"image", frame, "-o", o, "--ids", "x"}, two, "--ids");
    refused({"motionblur", frame, "-o", o, "--shutter", "0:1", "--ids", "x"}, two, "--ids");
    refused({"focus", a, "-o", o, "--f-number", "2", "--focus", "4", "--ids", "x"}, ExitCode::invalid_input,
            "no ids x");
    refused({"motionblur", frame, "-o", o, "--shutter", "0:1", "--layer", "x"}, two, "--layer");
}

TEST_F(ForeignCommand, DamagedFilesAreRefusedQuicklyAndWithLittleMemory) {
    const fs::path folder = fs::path(POSTLENS_TEST_DATA) / "exr-damaged";
    std::vector<std::string> files;
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    std::size_t refusals = 0;
    for (std::size_t i = 0; i < files.size(); ++i) {
        // The commands read a file alike, so each file is given to one of them, in turn.
        const std::array commands{Words{"focus", files[i], "--f-number", "2", "--focus", "4"},
                                  Words{"image", files[i]},
                                  Words{"motionblur", files[i], "--shutter", "0:1"}};
        const Words words =
            commands[i % commands.size()] + Words{"-o", in("o.exr"), "--threads", "1", "--quiet"};
        const Outcome r = run(words, ten_seconds_and_a_gibibyte());
        if (r.exit_code == 0) continue;
        EXPECT_EQ(r.exit_code, 3) << files[i] << " " << words[0] << ": " << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
        ++refusals;
    }
    EXPECT_GT(refusals, files.size() / 3);
    EXPECT_LT(most_kilobytes_of_commands(), 1024 * 1024);
}

}  // namespace
}  // namespace postlens::test::foreign_command_test
