// The command line: output, exit codes, and the files that remain after an error.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <tuple>
#include <unistd.h>
#include <vector>

#include "core/error.h"
#include "pictures/image.h"
#include "records/sample_file.h"
#include "tests/support/command_test.h"

namespace postlens::test::cli_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Sanitizers make the program several times slower.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double seconds_to_stop = 10;
#else
constexpr double seconds_to_stop = 1;
#endif

class Cli : public CommandTest {
  protected:
    std::string scene() { return POSTLENS_TEST_DATA "/nff/balls_s2.nff"; }
    std::string traced() {
        std::string path = in("frame.exr");
        const Outcome r =
            run({"trace", scene(), "-o", path, "--size", "96x96", "--metres-per-unit", "0.1", "--quiet"});
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return path;
    }
};

TEST_F(Cli, HelpNamesEverySubcommandWithUnits) {
    const Outcome r = run({"--help"});
    EXPECT_EQ(r.exit_code, 0);
    for (const char* sub : {"trace", "image", "records", "focus", "lens", "info"}) {
        EXPECT_NE(r.out.find(sub), std::string::npos) << sub;
        const Outcome h = run({sub, "--help"});
        EXPECT_EQ(h.exit_code, 0) << sub;
        EXPECT_FALSE(h.out.empty());
    }
    EXPECT_NE(run({"focus", "--help"}).out.find("MM"), std::string::npos);
    EXPECT_EQ(run({"--version"}).exit_code, 0);
}

TEST_F(Cli, TraceThenFocusThreeTimes) {
    const Outcome t =
        run({"trace", scene(), "-o", in("b.exr"), "--size", "96x96", "--metres-per-unit", "0.1", "--json"});
    ASSERT_EQ(t.exit_code, 0) << t.err;
    const json trace = json::parse(t.out);
    EXPECT_GT(trace.at("records"), 97 * 97);
    EXPECT_EQ(trace.at("bytes"), fs::file_size(in("b.exr")));
    EXPECT_GT(trace.at("rays").at("shadow"), 0);
    EXPECT_GE(trace.at("seconds"), 0.0);
    std::vector<std::string> pictures;
    for (const char* s : {"0.2", "0.3", "inf"}) {
        const std::string out = in(std::string("f") + s + ".exr");
        const Outcome f = run({"focus", in("b.exr"), "-o", out, "--focal-length", "50", "--f-number", "2",
                               "--focus", s, "--json"});
        ASSERT_EQ(f.exit_code, 0) << f.err;
        const json j = json::parse(f.out);
        EXPECT_EQ(j.at("method"), "layers");  // chosen because the balls are mirrors
        EXPECT_EQ(j.at("f_number"), 2.0);
        EXPECT_EQ(j.at("focal_length_mm"), 50.0);
        EXPECT_EQ(j.at("focus_m").is_null(), std::string(s) == "inf");
        pictures.push_back(bytes_of(out));
    }
    EXPECT_NE(pictures[0], pictures[1]);
    EXPECT_NE(pictures[1], pictures[2]);
}

TEST_F(Cli, ImagePinholeAndInfiniteFNumberAreOnePicture) {
    const std::string frame = traced();
    EXPECT_EQ(run({"image", frame, "-o", in("a.exr")}).exit_code, 0);
    EXPECT_EQ(run({"focus", frame, "-o", in("b.exr"), "--method", "pinhole"}).exit_code, 0);
    EXPECT_EQ(run({"focus", frame, "-o", in("c.exr"), "--f-number", "inf", "--focus", "3"}).exit_code, 0);
    const Image a = read_image(in("a.exr")), b = read_image(in("b.exr")), c = read_image(in("c.exr"));
    EXPECT_EQ(a.rgb, b.rgb);
    EXPECT_EQ(a.rgb, c.rgb);
    EXPECT_EQ(a.rgb, SampleFileReader(frame).picture().rgb);
}

TEST_F(Cli, RecordsAndInfoTellWhatIsThere) {
    const std::string frame = traced();
    const Outcome r = run({"records", frame, "--at", "48,60", "--f-number", "2", "--focus", "0.3", "--json"});
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json samples = json::parse(r.out).at("samples");
    double weight = 0;
    for (const json& s : samples) weight += s.at("weight").get<double>();
    EXPECT_NEAR(weight, 1, 1e-6);
    EXPECT_EQ(samples[0].at("nodes")[0].at("path"), "primary");
    EXPECT_TRUE(samples[0].at("nodes")[0].contains("coc_px"));
    const json info = json::parse(run({"info", frame, "--json"}).out);
    EXPECT_EQ(info.at("kind"), "samples");
    EXPECT_EQ(info.at("width"), 96);
    EXPECT_EQ(json::parse(run({"info", scene(), "--json"}).out).at("kind"), "scene");
    EXPECT_EQ(run({"image", frame, "-o", in("a.png")}).exit_code, 0);
    EXPECT_EQ(json::parse(run({"info", in("a.png"), "--json"}).out).at("kind"), "image");
    EXPECT_EQ(run({"focus", frame, "-o", in("at.png"), "--f-number", "2", "--focus-at", "48,60"}).exit_code,
              0);
}

TEST_F(Cli, LensNumbers) {
    const json coc = json::parse(run({"lens", "coc", "--focal-length", "50", "--f-number", "2", "--focus",
                                      "2", "--depth", "4", "--json"})
                                     .out);
    // CoC: F^2 (z - s) / (n z (s - F)) = 2500 * 2000 / (2 * 4000 * 1950) mm.
    EXPECT_NEAR(coc.at("coc_mm"), 2500.0 * 2000 / (2 * 4000 * 1950.0), 1e-12);
    EXPECT_NEAR(coc.at("coc_px"), coc.at("coc_mm").get<double>() * 1000 / 18.75, 1e-9);
    const json dof = json::parse(run({"lens", "dof", "--focal-length", "28", "--f-number", "8", "--focus",
                                      "4", "--coc-limit", "0.03", "--json"})
                                     .out);
    EXPECT_TRUE(dof.at("far_m").is_null());
    EXPECT_NEAR(dof.at("near_m"), 1.80512, 1e-5);
}

TEST_F(Cli, WrongArgumentsAreTwo) {
    const std::string frame = traced();
    const ExitCode two = ExitCode::wrong_arguments;
    refused({}, two, "subcommand");
    refused({"nonsense"}, two, "nonsense");
    refused({"trace"}, two, "SCENE: missing");
    refused({"trace", scene()}, two, "--output");
    refused({"trace", scene(), "-o", in("x.exr"), "--size", "0x5"}, two, "--size");
    refused({"trace", scene(), "-o", in("x.exr"), "--size", "5"}, two, "WxH");
    refused({"trace", scene(), "-o", in("x.exr"), "--size", "99999999x5"}, two, "--size");
    refused({"trace", scene(), "-o", in("x.exr"), "--subdivide", "99"}, two, "--subdivide");
    refused({"trace", scene(), "-o", in("x.exr"), "--threshold", "nan"}, two, "--threshold");
    refused({"trace", scene(), "-o", in("x.exr"), "--overscan", "-4"}, two, "--overscan");
    refused({"trace", scene(), "-o", in("x.exr"), "--metres-per-unit", "0"}, two, "metres");
    refused({"trace", scene(), "-o", in("x.exr"), "--film-distance", "1e999"}, two, "--film-distance");
    refused({"trace", scene(), "-o", in("x.exr"), "--focal-length", "85"}, two, "expected --film-distance");
    refused({"trace", scene(), "-o", in("x.exr"), "--threads", "-1"}, two, "--threads");
    refused({"focus", frame, "-o", in("x.png"), "--f-number", "0", "--focus", "1"}, two, "f-number");
    refused({"focus", frame, "-o", in("x.png"), "--f-number", "-2", "--focus", "1"}, two, "f-number");
    refused({"focus", frame, "-o", in("x.png"), "--f-number", "nan", "--focus", "1"}, two, "--f-number");
    refused({"focus", frame, "-o", in("x.png"), "--f-number", "2", "--focus", "0"}, two, "focus");
    refused({"focus", frame, "-o", in("x.png"), "--f-number", "2", "--focus", "1", "--focal-length", "0"},
            two, "focal");
    refused({"focus", frame, "-o", in("x.png"), "--f-number", "2"}, two, "--focus");
    refused({"focus", frame, "-o", in("x.png"), "--f-number", "2", "--focus", "0.01", "--breathing"}, two,
            "focus");
    refused({"focus", frame, "-o", in("x.png"), "--f-number", "2", "--focus", "1", "--method", "magic"}, two,
            "scatter");
    refused({"focus", frame, "-o", in("x.png"), "--f-number", "2", "--focus", "1", "--depths", "1"}, two,
            "depths");
    refused({"focus", frame, "-o", in("x.xyz"), "--f-number", "2", "--focus", "1"}, two, "x.xyz");
    refused({"records", frame, "--at", "1e9,0"}, two, "--at");
    refused({"records", frame, "--at", "5000,0"}, two, "--at");
    refused({"lens", "coc", "--focal-length", "50", "--f-number", "2", "--focus", "0.04", "--depth", "1"},
            two, "--focus");
}

// Bounds of an option are checked even if the option has no effect on the command.
TEST_F(Cli, BoundsHoldForEveryValueThatIsGiven) {
    struct Case {
        std::vector<std::string> command, out_of_range;
    };
    const std::vector<Case> cases{
        {{"focus", "a.exr", "-o", in("x.exr")},
         {"--views",        "-1",   "--views",           "0",  "--views",    "4097", "--depths",  "1",
          "--target-db",    "1000", "--metres-per-unit", "-1", "--f-number", "-2",   "--focus",   "0",
          "--focal-length", "0",    "--squeeze",         "11", "--cats-eye", "2",    "--threads", "5000"}},
        {{"compare", "a.exr", "b.exr"},
         {"--f-number", "0", "--focus", "-1", "--depths", "1", "--shutter", "1:0", "--metres-per-unit", "0",
          "--fail-flip", "2", "--flip-white", "0"}},
        {{"shoot", "a.exr", "-o", in("x.exr")}, {"--views", "0", "--target-db", "9", "--shutter", "2:1"}},
        {{"sweep", "a.exr", "-o", in("x")},
         {"--views", "0", "--depths", "1", "--target-db", "81", "--coc-limit", "0", "--metres-per-unit",
          "-1"}},
        {{"trace", "a.toml", "-o", in("x.exr")},
         {"--target-db", "9", "--for-focus", "0", "--fps", "0", "--threshold", "-1", "--max-depth", "18",
          "--film-width", "0"}},
        {{"lens", "fit", "a.toml"},
         {"--coc-limit", "0", "--focal-length", "-1", "--wavelength", "1", "--samples", "2", "--f-number",
          "0"}},
    };
    for (const Case& c : cases) {
        for (std::size_t i = 0; i < c.out_of_range.size(); i += 2) {
            std::vector<std::string> words = c.command;
            words.insert(words.end(), {c.out_of_range[i], c.out_of_range[i + 1]});
            const std::string what =
                c.out_of_range[i] == "--shutter" ? "closes before it opens" : "out of range";
            std::string said = c.out_of_range[i];
            said.append(": ").append(what).append(" (got ").append(c.out_of_range[i + 1]);
            refused(words, ExitCode::wrong_arguments, said);
        }
    }
    refused({"focus", "a.exr", "-o", in("x.exr"), "--views", "99999999999"}, ExitCode::wrong_arguments,
            "--views: too large (got 99999999999; expected 1 to 4096)");
    refused({"image", "a.exr", "-o", in("x.exr"), "--threads", "-99999999999"}, ExitCode::wrong_arguments,
            "--threads: too small (got -99999999999; expected 0 to 4096)");
    refused({"render", scene(), "-o", in("x.exr"), "--spp", "99999999999"}, ExitCode::wrong_arguments,
            "--spp: too large (got 99999999999; expected 1 to ");
    EXPECT_NE(run({"focus", "--help"}).out.find("Aperture number n, more than 0; inf"), std::string::npos);
}

TEST_F(Cli, ThreadsThatCannotBeStartedAreOneError) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer's address space cannot be limited";
#endif
    const auto limited = [&](const char* threads) {
        return run({"render", scene(), "-o", in("x.exr"), "--size", "8x8", "--spp", "1", "--f-number", "2",
                    "--focus", "1", "--quiet", "--threads", threads},
                   "ulimit -v 1500000; timeout 20 ");
    };
    const Outcome many = limited("1000");
    EXPECT_EQ(many.exit_code, static_cast<int>(ExitCode::out_of_memory));
    EXPECT_TRUE(many.err.starts_with("postlens: cannot start the threads (got ")) << many.err;
    EXPECT_EQ(std::count(many.err.begin(), many.err.end(), '\n'), 1) << many.err;
    EXPECT_FALSE(fs::exists(in("x.exr")));
    EXPECT_EQ(limited("2").exit_code, 0);
}

TEST_F(Cli, ThreadsOfThePictureModuleThatCannotBeStartedAreOneError) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer has a thread of its own";
#endif
    if (::geteuid() != 0) GTEST_SKIP() << "only root can be a user who has no other processes";
    const std::string frame = traced(), out = in("out");
    fs::create_directory(out);
    fs::permissions(in("."), fs::perms::others_exec | fs::perms::others_read, fs::perm_options::add);
    fs::permissions(out, fs::perms::all);
    const auto limited = [&](int processes, const char* threads) {
        return run({"image", frame, "-o", out + "/x.jpg", "--quiet", "--threads", threads},
                   "setpriv --reuid=61111 --regid=61111 --clear-groups prlimit --nproc=" +
                       std::to_string(processes) + " timeout 60 ");
    };
    // The loader waits forever if it can start some of the module's four threads, and aborts if it can start
    // none. `timeout` is a process, too.
    for (const int processes : {2, 4, 5}) {
        const Outcome few = limited(processes, "1");
        EXPECT_EQ(few.exit_code, static_cast<int>(ExitCode::out_of_memory)) << processes << few.err;
        EXPECT_TRUE(few.err.starts_with("postlens: cannot start the threads (got ")) << few.err;
        EXPECT_EQ(std::count(few.err.begin(), few.err.end(), '\n'), 1) << few.err;
    }
    EXPECT_FALSE(fs::exists(out + "/x.jpg"));
    EXPECT_EQ(limited(40, "2").exit_code, 0);
}

// Names and metadata of files may contain commands for the terminal.
TEST_F(Cli, TextsHaveNoControlCharacters) {
    const std::string odd = in("a\x1b[31m.exr");
    fs::rename(traced(), odd);
    const Outcome r = run({"info", odd});
    EXPECT_NE(r.out.find("a?[31m.exr: postlens samples"), std::string::npos) << r.out;
    EXPECT_EQ(json::parse(run({"info", odd, "--json"}).out)["kind"], "samples");
}

TEST_F(Cli, AFolderThatCannotBeMadeIsOneError) {
    const std::string long_name = in(std::string(300, 'x'));  // names have at most 255 bytes
    refused({"sweep", traced(), "-o", long_name, "--f-number", "2", "--focus", "2"}, ExitCode::cannot_write,
            "xx: cannot make this folder (");
    refused({"chart", POSTLENS_SAMPLES "/scenes/bars.toml", "-o", long_name, "--size", "8x8"},
            ExitCode::cannot_write, "xx: cannot make this folder (");
}

TEST_F(Cli, WhatIsWrongIsNamed) {
    const ExitCode two = ExitCode::wrong_arguments;
    const std::string frame = traced(), lens = POSTLENS_SAMPLES "/lenses/double_gauss.toml";
    refused({"lens", "nosuch"}, two, "(got nosuch; expected one of coc, dof");
    refused({"--nonsense"}, two, "unknown option (got --nonsense");
    const Words image{"image", frame, "-o", in("x.exr")};
    refused(image + Words{"--explosure=1"}, two,
            "unknown option (got --explosure; nearest known option: --exposure, see postlens image --help)");
    refused({"focus", frame, "-o", in("x.exr"), "--methd", "layers"}, two,
            "unknown option (got --methd; nearest known option: --method, see postlens focus --help)");
    refused({"lens", "psf", in("x.exr"), "--focal-lenght", "50", "--f-number"}, two,
            "unknown option (got --focal-lenght; nearest known option: --focal-length, see postlens lens psf "
            "--help)");
    refused(image + Words{"-f", "3"}, two, "unknown option (got -f; see postlens image --help)");
    refused(image + Words{"--expo", "3"}, two, "(got --expo; nearest known option: --exposure, see");
    refused(image + Words{"--spp", "3"}, two, "unknown option (got --spp; see postlens image --help)");
    refused(image + Words{"-exposure", "3"}, two, "(got -exposure; nearest known option: --exposure, see");
    refused(image + Words{"---"}, two, "unknown option (got ---;");
    refused({"lens"}, two, "no subcommand (got nothing; expected one of coc, dof");
    refused({"focus", "-o", in("x.exr")}, two,
            "FRAME: missing (got nothing; expected a value, see postlens focus --help)");
    refused({"focus", frame}, two,
            "--output: missing (got nothing; expected FILE, see postlens focus --help)");
    refused(image + Words{"--exposure"}, two, "--exposure: no value (got nothing; expected STOPS|auto)");
    refused(image + Words{"--exposure", "2", "--exposure"}, two, "--exposure: no value (got nothing;");
    refused(image + Words{"--exposure", "2", "--exposure", "3"}, two,
            "--exposure: stated 2 times (got '2 and 3'; expected one value)");
    refused(image + Words{"--quiet=maybe"}, two, "--quiet: takes no value (got 'maybe')");
    for (const char* value : {"false", "0", "true", ""}) {
        refused({"focus", frame, "-o", in("x.exr"), "--f-number", "2", std::string("--breathing=") + value},
                two, "--breathing: takes no value");
    }
    refused({"view", frame, "--export", in("x.html"), "--port", "0"}, two, "--port: not with --export");
    refused({"view", frame, "--export", in("x.html"), "--open"}, two, "--open: not with --export");
    refused({"view", frame, "--export-mb", "3"}, two, "--export-mb: goes with --export");
    refused({"view", frame, "missing.toml", "--export", in("x.html")}, two,
            "SCENE: not with --export, whose page is made from the records alone (got missing.toml;");
    refused(image + Words{"left", "over"}, two, "not expected: over left (see postlens image --help)");
    refused({"lens", "show", lens, "-o", in("x.foo")}, two, "expected svg, exr, png");
    refused({"lens", "trace", lens, "-o", in("x.foo")}, two, "expected csv, svg, exr, png");
    refused({"sweep", frame, "-o", in("s"), "--f-number", "2", "--focus", "1", "--frames", "p.%04d.gif"}, two,
            "--frames: unknown kind of image (got ending \".gif\"");
    refused({"sweep", frame, "-o", in("no/dir"), "--f-number", "2", "--focus", "1"}, ExitCode::cannot_write,
            "no/dir: cannot make this folder");
    refused({"image", frame, "-o", frame + "/o.exr"}, ExitCode::cannot_write, "frame.exr is a file");
    // As of a shell variable that is not set: the image was made and not written, with exit code 0.
    const std::string empty = ": no value (got an empty text; expected ";
    refused({"image", frame, "-o", ""}, two, "--output" + empty + "FILE)");
    refused({"focus", frame, "-o", "", "--f-number", "2", "--focus", "1"}, two, "--output" + empty);
    refused({"render", scene(), "-o", "", "--size", "8x8", "--spp", "1"}, two, "--output" + empty);
    refused({"trace", scene(), "-o", in("x.exr"), "--size", "8x8", "--camera", ""}, two, "--camera" + empty);
    refused({"view", frame, "--export", ""}, two, "--export" + empty + "PAGE.html)");
    refused({"image", "", "-o", in("x.exr")}, two, "FRAME" + empty + "FRAME)");
    refused({"focus", frame, "-o", in("x.exr"), "--f-number", "2", "--focus", "1", "--overscan", "nan"}, two,
            "--overscan: not a whole number (got nan");
    refused({"motionblur", frame, "-o", in("x.exr"), "--shutter", "0:1", "--shutter-curve", "bx"},
            ExitCode::invalid_input,
            "--shutter-curve: no such file (got bx; expected box, triangle or a file)");
    // What would have no effect.
    const auto refused_with = [&](const Words& words, const Words& more, const std::string& part) {
        refused(words + Words{"--f-number", "2", "--focus", "1"} + more, two, part);
    };
    const Words focus{"focus", frame, "-o", in("x.exr")}, sweep{"sweep", frame, "-o", in("s")},
        shoot{"shoot", frame, "-o", in("x.exr"), "--shutter", "0:1"};
    refused_with(focus, {"--target-db", "40", "--method", "layers"},
                 "--target-db: not with the method layers");
    refused_with(sweep, {"--target-db", "40", "--method", "hybrid"},
                 "--target-db: not with the method hybrid");
    for (const Words& words : {focus, sweep}) {
        for (const std::string method : {"scatter", "layers", "pinhole", "auto"}) {
            refused_with(words, {"--views", "9", "--method", method, "--scene", scene()},
                         "--views: not with the method " + method + " (expected lightfield or hybrid)");
        }
        for (const std::string method : {"lightfield", "hybrid", "pinhole", "auto"}) {
            refused_with(words, {"--depths", "9", "--method", method, "--scene", scene()},
                         "--depths: not with the method " + method + " (expected scatter or layers)");
        }
        refused_with(words, {"--views", "9"}, "--views: not with the method ");  // the usual one
        for (const std::string method : {"scatter", "layers", "lightfield", "pinhole"}) {
            refused_with(words, {"--scene", scene(), "--method", method},
                         "--scene: not with the method " + method + ", which traces no rays");
        }
        for (const std::string method : {"lightfield", "hybrid", "auto"}) {
            const Words by{"--method", method, "--target-db", "40"};
            const Words asked(by.begin(), by.begin() + (method == "auto" ? 4 : 2));
            refused_with(words, asked + Words{"--spacing", "linear"}, "--spacing: not with the method ");
            refused_with(words, asked + Words{"--depth-model", "path"},
                         "--depth-model: " + method + " knows");
        }
    }
    refused_with(shoot, {"--views", "9", "--method", "auto"}, "--views: not with the method auto");
    const Words blur{"motionblur", frame, "-o", in("x.exr"), "--shutter", "0:1", "--views", "9"};
    refused(blur + Words{"--scene", scene()}, two, "(expected --method lightfield)");
    refused(blur + Words{"--method", "convolve"}, two, "(expected auto or lightfield)");
    refused(blur + Words{"--method", "lightfield", "--fit-paths", "1"}, two,
            "--fit-paths: not with the method lightfield (expected auto or convolve)");
    refused_with(focus, {"--explain", in("e.png"), "--method", "layers"},
                 "--explain: not with the method layers, which traces no rays (expected hybrid or auto)");
    for (const Words& words : {shoot, sweep + Words{"--shutter", "0:1"}})
        refused_with(words, {"--target-db", "40"}, "--target-db: not with the method lightfield");
    for (const Words& words : {focus, sweep, shoot}) {
        refused_with(words, {"--metres-per-unit", "2"}, "--metres-per-unit: of which scene? (got 2");
        refused_with(words, {"--lumens-per-watt", "1"}, "--lumens-per-watt: of which scene? (got 1");
    }
    refused({"motionblur", frame, "-o", in("x.exr"), "--shutter", "0:1", "--metres-per-unit", "2"}, two,
            "--metres-per-unit: of which scene?");
    const Words still{"render", scene(), "-o", in("x.exr"), "--size", "8x8", "--spp", "1"},
        record{"trace", scene(), "-o", in("x.exr"), "--size", "8x8"}, judge{"compare", frame, frame};
    for (const auto& [words, more, other] : std::vector<std::tuple<Words, Words, const char*>>{
             {record, {"--target-db", "30"}, "--plan"},
             {record, {"--for-focus", "3"}, "--for-f-number"},
             {still, {"--shutter-curve", "triangle"}, "--shutter"},
             {still, {"--share-by", "samples"}, "--share"},
             {sweep, {"--shutter-curve", "triangle", "--f-number", "2", "--focus", "1"}, "--shutter"},
             {sweep, {"--paths", frame, "--f-number", "2", "--focus", "1"}, "--shutter"},
             {judge, {"--f-number", "2"}, "--map-causes"},
             {judge, {"--focus", "2"}, "--map-causes"},
             {judge, {"--focal-length", "50"}, "--map-causes"},
             {judge, {"--shutter", "0:1"}, "--map-causes"},
             {judge, {"--depths", "8"}, "--map-causes"},
             {{"lens", "trace", lens}, {"--pixel-pitch", "3"}, "--impulse"}}) {
        refused(words + more, two, more[0] + ": goes with " + other + " (got it alone)");
    }
    refused(still + Words{"--shutter", "0:1", "--time", "1"}, two, "--time: not with --shutter");
    for (const char* option : {"--subdivide", "--overscan", "--keys"}) {
        refused(record + Words{"--for-shutter", "0:1", "--plan", option, "1"}, two,
                std::string(option) + ": not with --plan, which chooses it (got 1; expected one of them)");
    }
    for (const Words& words : {shoot, sweep + Words{"--shutter", "0:1"}})
        refused_with(words, {"--breathing"}, "--framing, --breathing: not with hybrid and shoot");
    refused({"chart", "--atlas", in("."), "-o", in("c"), "--rays", "4"}, two,
            "--rays: not with --atlas, whose cases state their own settings");
    // What must be given has no default.
    for (const char* command : {"coc", "dof"})
        EXPECT_NE(run({"lens", command, "--help"}).out.find("Focal length F, more than 0\n"),
                  std::string::npos);
    EXPECT_NE(run({"render", "--help"}).out.find("Samples per pixel, 1 to 1048576\n"), std::string::npos);
    EXPECT_NE(run({"sweep", "--help"}).out.find("[default: 40 with --scene or --shutter, else"),
              std::string::npos);
    EXPECT_NE(run({"merge", "--help"}).out.find("of a sweep or a chart, the folder"), std::string::npos);
    EXPECT_EQ(run({"lens", "psf", "--help"}).out.find("lens:PRESCRIPTION"), std::string::npos);
    EXPECT_NE(run({"focus", "--help"}).out.find("lens:PRESCRIPTION"), std::string::npos);
}

TEST_F(Cli, NumbersAreReadable) {
    const std::string frame = traced();
    const Outcome far = run({"focus", frame, "-o", in("x.exr"), "--focal-length", "1e300", "--f-number", "2",
                             "--focus", "1", "--method", "layers"});
    EXPECT_LT(far.out.size() + far.err.size(), 1200U) << far.out << far.err;
    const Outcome axis = run({"lens", "trace", POSTLENS_SAMPLES "/lenses/double_gauss.toml"});
    EXPECT_NE(axis.out.find("chief ray at 0 mm"), std::string::npos) << axis.out;

    EXPECT_EQ(run({"image", frame, "-o", in("crop.exr"), "--crop", "8,8,16,16", "--quiet"}).exit_code, 0);
    const Outcome crop = run({"info", in("crop.exr")});
    EXPECT_NE(crop.out.find("96x96 px, 4 channels"), std::string::npos) << crop.out;
    const Outcome depth = run({"info", POSTLENS_TEST_DATA "/exr/deep_alpha.exr"});
    EXPECT_EQ(depth.out.find(", , "), std::string::npos) << depth.out;
    EXPECT_NE(depth.out.find("colour none, alpha A"), std::string::npos) << depth.out;
    const Outcome one = run({"info", POSTLENS_TEST_DATA "/exr/deep_one_sample.exr"});
    EXPECT_NE(one.out.find(" 1 channel,"), std::string::npos) << one.out;
    EXPECT_EQ(run({"info", scene()}).out.find("1 lights"), std::string::npos);
    // The parser would go through the parts of a key recursively. Dots in texts and comments are no parts.
    std::string parts = "a";
    for (int i = 0; i < 100'000; ++i) parts += ".a";
    const std::string dots(1000, '.');
    for (const std::string& text : {parts + " = 1", "[" + parts + "]", "x = {" + parts + " = 1}"}) {
        std::ofstream(in("parts.toml")) << "# " << dots << "\ny = \"" << dots << "\"\n" << text << "\n";
        const Outcome r = run({"info", in("parts.toml")});
        EXPECT_EQ(r.exit_code, 3);
        EXPECT_NE(r.err.find("parts.toml:3: not valid TOML: a key of too many parts"), std::string::npos)
            << r.err;
    }
    ASSERT_EQ(::mkfifo(in("pipe.exr").c_str(), 0600), 0);
    for (const Words& words :
         {Words{"info", in("pipe.exr")}, Words{"merge", in("pipe.exr"), "-o", in("m.exr")}}) {
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 3);
        EXPECT_NE(r.err.find("got a device or pipe; expected a file"), std::string::npos) << r.err;
    }
    // An error is one line, whatever is in a name.
    const Outcome line = run({"info", in("two\nlines\033.exr")});
    EXPECT_EQ(line.exit_code, 3);
    EXPECT_NE(line.err.find("two?lines?.exr: cannot read (no such file)\n"), std::string::npos) << line.err;
}

TEST_F(Cli, UnreadableInputIsThree) {
    const ExitCode three = ExitCode::invalid_input;
    const std::string frame = traced();
    refused({"trace", in("none.toml"), "-o", in("x.exr")}, three, "none.toml");
    refused({"trace", in("."), "-o", in("x.exr")}, three, "");
    refused({"focus", in("none.exr"), "-o", in("x.png"), "--f-number", "2", "--focus", "1"}, three,
            "none.exr");
    refused({"focus", in("."), "-o", in("x.png"), "--f-number", "2", "--focus", "1"}, three, "");
    refused({"image", scene(), "-o", in("x.png")}, three, "balls_s2.nff");
    refused({"info", in("none")}, three, "none");
    std::ofstream(in("empty.exr")).close();
    refused({"image", in("empty.exr"), "-o", in("x.png")}, three, "empty.exr");
    const std::string whole = bytes_of(frame);
    for (const double share : {0.01, 0.3, 0.6, 0.999}) {
        std::ofstream(in("cut.exr"), std::ios::binary)
            << whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size())));
        refused({"image", in("cut.exr"), "-o", in("x.png")}, three, "cut.exr");
    }
    std::string flipped = whole;
    flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x10);
    std::ofstream(in("flip.exr"), std::ios::binary) << flipped;
    refused({"image", in("flip.exr"), "-o", in("x.png")}, three, "flip.exr");
}

TEST_F(Cli, UnwritableOutputIsFour) {
    const ExitCode four = ExitCode::cannot_write;
    const std::string frame = traced();
    refused({"trace", scene(), "-o", in("no/such/x.exr"), "--size", "8x8"}, four, "x.exr");
    refused({"image", frame, "-o", in("no/such/x.png")}, four, "x.png");
    fs::create_directory(folder_.path() / "folder.png");
    refused({"image", frame, "-o", in("folder.png")}, four, "folder.png");
    // Simulates a full disk: no file may exceed 20 kB. An existing file must stay unchanged.
    std::ofstream(in("old.exr")) << "old";
    const Outcome r = run({"trace", scene(), "-o", in("old.exr")}, "ulimit -f 20; ");
    EXPECT_EQ(r.exit_code, 4) << r.err;
    EXPECT_EQ(bytes_of(in("old.exr")), "old");
    EXPECT_EQ(folder_.file_count(), 2U);
}

TEST_F(Cli, OpenImageIOIsLoadedByWhatNeedsItAlone) {
    const std::string frame = traced();
    program_ = in("postlens");
    fs::copy_file(POSTLENS_BINARY, program_);
    for (const char* name : {"x.exr", "x.png"})
        EXPECT_EQ(run({"image", frame, "-o", in(name)}).exit_code, 0) << name;
    const std::string module = "/postlens_pictures.so: cannot be loaded (";
    refused({"image", frame, "-o", in("x.jpg")}, ExitCode::invalid_input, module);
    // The error must come before any work: this render would take hours.
    refused({"render", scene(), "-o", in("x.tif"), "--size", "4096x4096", "--spp", "10000"},
            ExitCode::invalid_input, module);
    EXPECT_EQ(run({"compare", in("x.exr"), in("x.png"), "--json"}).exit_code, 0);
    std::ofstream(in("cut.png")) << "\x89PNG";
    refused({"compare", in("cut.png"), in("x.exr")}, ExitCode::invalid_input, module);
    program_ = POSTLENS_BINARY;
    ASSERT_EQ(run({"image", frame, "-o", in("x.jpg")}).exit_code, 0);
    EXPECT_EQ(run({"compare", in("x.jpg"), in("x.png")}).exit_code, 0);
}

TEST_F(Cli, StrictTurnsAShortfallIntoSix) {
    const std::string frame = traced();
    const std::vector<std::string> words{"focus", frame,     "-o",  in("x.exr"), "--f-number",
                                         "1",     "--focus", "0.4", "--json"};
    const Outcome lax = run(words);
    EXPECT_EQ(lax.exit_code, 0) << lax.err;
    EXPECT_FALSE(json::parse(lax.out).at("warnings").empty());
    auto strict = words;
    strict.emplace_back("--strict");
    EXPECT_EQ(run(strict).exit_code, 6);
    EXPECT_TRUE(fs::exists(in("x.exr")));
}

TEST_F(Cli, CtrlCStopsWithinASecondAndLeavesNothing) {
    const std::string samples = POSTLENS_SAMPLES;
    Words lens{"lens", "trace",         samples + "/lenses/double_gauss.toml",
               "-o",   in("spots.csv"), "--rays",
               "1025", "--fields",      "0"};
    for (int field = 1; field < 40; ++field) lens.back() += fmt::format(",{}", field / 10.0);
    for (const Words& words : {Words{"trace", samples + "/scenes/still_life.toml", "-o", in("big.exr"),
                                     "--size", "7680x4320", "--quiet"},
                               lens}) {
        const pid_t child = begin(words);
        wait_for_handler(child);
        wait_for_work(child, std::chrono::milliseconds(500));
        ASSERT_EQ(::kill(child, SIGINT), 0);
        const auto start = std::chrono::steady_clock::now();
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        ASSERT_TRUE(WIFEXITED(status)) << words[0];
        EXPECT_EQ(WEXITSTATUS(status), 130) << words[0];
        EXPECT_LT(seconds, seconds_to_stop) << words[0];
        EXPECT_EQ(folder_.file_count(), 0U) << words[0];
    }
}

}  // namespace
}  // namespace postlens::test::cli_test
