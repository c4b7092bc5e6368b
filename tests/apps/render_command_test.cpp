// The command `postlens render`: rejected arguments, and the files that remain after an interruption.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "pictures/image.h"
#include "tests/support/command_test.h"

namespace postlens::test::render_command_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Sanitizers make the program several times slower.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int slower = 6;
#else
constexpr int slower = 1;
#endif

class Render : public CommandTest {
  protected:
    // A moving ball in front of a camera with a lens; `more` is appended to the file.
    std::string scene(const std::string& more = "", const std::string& name = "scene.toml") {
        std::string path = in(name);
        std::ofstream(path) << "[[camera]]\n"
                               "focal_length_mm = 50\n"
                               "width_px = 48\n"
                               "height_px = 32\n"
                               "f_number = 2\n"
                               "focus_m = 3\n"
                               "\n"
                               "[[light]]\n"
                               "kind = \"sphere\"\n"
                               "position_m = [2, 3, 1]\n"
                               "radius_m = 0.5\n"
                               "\n"
                               "[[object]]\n"
                               "shape = \"sphere\"\n"
                               "radius_m = 0.5\n"
                               "keys = [{ time_s = 0, translate_m = [-0.5, 0, -3] }, "
                               "{ time_s = 1, translate_m = [0.5, 0.2, -4] }]\n"
                               "\n"
                               "[[object]]\n"
                               "shape = \"plane\"\n"
                               "normal = [0, 1, 0]\n"
                               "point_m = [0, -0.5, 0]\n"
                            << more;
        return path;
    }
    Words render(const std::string& output, const Words& more = {}) {
        return Words{"render", scene(), "-o", in(output), "--shutter", "0:1"} + more;
    }
};

TEST_F(Render, HalvesOfAGridAreSaidToShareItsError) {
    const Words words = render("x.exr", {"--spp", "16", "--halves", "--json"});
    EXPECT_NE(run(words + Words{"--sampler", "grid"}).out.find("the grid's own error"), std::string::npos);
    EXPECT_EQ(run(words + Words{"--sampler", "sobol"}).out.find("the grid's own error"), std::string::npos);
}

TEST_F(Render, WritesThePictureAndItsHalves) {
    const Outcome r = run(render("x.exr", {"--spp", "16", "--halves", "--json", "--seed", "7"}));
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json j = json::parse(r.out);
    EXPECT_EQ(j.at("spp"), 16);
    EXPECT_EQ(j.at("rays").at("eye"), 48 * 32 * 16);
    EXPECT_GT(j.at("rays").at("shadow"), 0);
    EXPECT_EQ(j.at("sampler"), "sobol");
    EXPECT_EQ(j.at("f_number"), 2.0);
    EXPECT_EQ(j.at("focus_m"), 3.0);
    EXPECT_EQ(j.at("focal_length_mm"), 50.0);
    EXPECT_TRUE(j.at("warnings").empty()) << r.out;
    const Image x = read_image(in("x.exr")), a = read_image(in("x.a.exr")), b = read_image(in("x.b.exr"));
    EXPECT_EQ(x.width, 48);
    EXPECT_EQ(x.height, 32);
    for (std::size_t i = 0; i < x.rgb.size(); ++i) {
        const double mean = 0.5 * (static_cast<double>(a.rgb[i]) + static_cast<double>(b.rgb[i]));
        EXPECT_NEAR(static_cast<double>(x.rgb[i]), mean, 0x1p-23 * mean);
    }
    EXPECT_EQ(folder_.file_count(), 4U);  // with the scene
    // These options change the image.
    for (const Words& more : {Words{"--shutter-curve", "triangle"}, Words{"--sampler", "poisson"},
                              Words{"--f-number", "inf"}, Words{"--focus-at", "24,30"}}) {
        EXPECT_EQ(run(render("y.exr", Words{"--spp", "16", "--quiet"} + more)).exit_code, 0) << more[0];
        EXPECT_NE(read_image(in("y.exr")).rgb, x.rgb) << more[0];
    }
    for (const char* name : {"y.png", "y.tif", "y.jpg"})
        EXPECT_EQ(run(render(name, {"--spp", "1", "--quiet"})).exit_code, 0) << name;
}

TEST_F(Render, WrongArgumentsAreTwo) {
    const ExitCode two = ExitCode::wrong_arguments;
    const Words ok = render("x.exr", {"--spp", "4"});
    refused(render("x.exr"), two, "--spp");
    refused(render("x.exr", {"--spp", "4", "--impulse", "diffraction"}), two,
            "--impulse: rays do not diffract (got diffraction; expected disc, polygon, image or lens)");
    for (const char* spp : {"0", "-1", "2147483648", "1048577", "1.5"})
        refused(render("x.exr", {"--spp", spp}), two, "--spp");
    refused(render("x.exr", {"--spp", "5", "--halves"}), two, "even");
    const auto shutter = [&](const char* span) {
        return Words{"render", scene(), "-o", in("x.exr"), "--spp", "4", "--shutter", span};
    };
    for (const char* span : {"0.2:0.1", "nan:1", "0:inf", "1", "0:1:2", ""})
        refused(shutter(span), two, "--shutter");
    refused(ok + Words{"--sampler", "halton"}, two, "halton");
    for (const char* n : {"0", "nan"}) refused(ok + Words{"--f-number", n}, two, "number");
    for (const char* s : {"0", "-1"}) refused(ok + Words{"--focus", s}, two, "focus");
    for (const char* f : {"0", "inf"}) refused(ok + Words{"--focal-length", f}, two, "focal");
    refused(ok + Words{"--focus", "0.04", "--breathing"}, two, "within the focal length");
    for (const char* size : {"0x32", "65537x2", "48"}) refused(ok + Words{"--size", size}, two, "--size");
    refused(ok + Words{"--max-depth", "0"}, two, "--max-depth");
    refused(ok + Words{"--min-contribution", "-1"}, two, "--min-contribution");
    refused(ok + Words{"--seed", "-1"}, two, "--seed");
    refused(ok + Words{"--camera", "none"}, two, "none");
    refused({"render", scene(), "-o", in("x.what"), "--spp", "4"}, two, "x.what");
}

TEST_F(Render, BadScenesAreThreeAndNameTheLine) {
    const ExitCode three = ExitCode::invalid_input;
    const auto bad = [&](const std::string& more, const std::string& part) {
        refused({"render", scene(more, "bad.toml"), "-o", in("x.exr"), "--spp", "4"}, three, part);
    };
    std::ofstream(in("bad.toml")).close();  // created now, so that the number of files stays constant
    scene();
    // The appended text begins after 22 lines.
    bad("\n[[object]]\nshape = \"box\"\nsize_m = 1\nkeys = [{ time_s = 1 },\n  { time_s = 0.5 }]\n",
        "bad.toml:27:");
    bad("\n[[object]]\nshape = \"box\"\nsize_m = 1\nkeys = [{ time_s = 1 },\n  { time_s = 1 }]\n",
        "does not grow");
    bad("\n[[object]]\nshape = \"box\"\nsize_m = 1\n"
        "matrix = [[1, 0, 0, 0], [2, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n",
        "bad.toml:26:");
    bad("\n[[object]]\nshape = \"box\"\nsize_m = 1\nscale = 0\n", "bad.toml:26:");
    bad("\n[[object]]\nshape = \"box\"\nsize_m = 1\n"
        "keys = [{ time_s = 0 }, { time_s = 1, rotate_degrees = 180, rotate_axis = [0, 1, 0] }]\n",
        "bad.toml:26:");
    refused({"render", in("none.toml"), "-o", in("x.exr"), "--spp", "4"}, three, "none.toml");
}

TEST_F(Render, BadShutterCurvesAreThree) {
    const ExitCode three = ExitCode::invalid_input;
    scene();
    refused(render("x.exr", {"--spp", "4", "--shutter-curve", in("none.txt")}), three, "none.txt");
    refused(render("x.exr", {"--spp", "4", "--shutter-curve", "bok"}), three, "bok");
    std::ofstream(in("curve.txt")) << "0 0\n0.5 x\n";
    refused(render("x.exr", {"--spp", "4", "--shutter-curve", in("curve.txt")}), three, "curve.txt:2:");
    refused(render("x.exr", {"--spp", "4", "--shutter-curve", folder_.path().string()}), three,
            "cannot read");
}

TEST_F(Render, UnwritableOutputIsFour) {
    const ExitCode four = ExitCode::cannot_write;
    scene();
    // The error must come before any work: this number of samples would take hours.
    const Words long_work{"--spp", "1048576"};
    refused(render("no/such/x.exr", long_work), four, "x.exr");
    fs::create_directory(in("folder.exr"));
    refused(render("folder.exr", long_work), four, "folder.exr");
    // The path of the unfinished image must also be writable.
    fs::create_directory(in("y.partial.exr"));
    refused(render("y.exr", long_work), four, "y.partial.exr");
    if (::geteuid() != 0) {  // root can write everywhere
        fs::create_directory(in("locked"));
        fs::permissions(in("locked"), fs::perms::owner_read | fs::perms::owner_exec);
        refused(render("locked/x.exr", long_work), four, "x.exr");
        fs::permissions(in("locked"), fs::perms::owner_all);
    }
    // Simulates a full disk. An existing image must stay unchanged.
    std::ofstream(in("old.exr")) << "old";
    const Outcome r = run(render("old.exr", {"--spp", "1"}), "ulimit -f 2; ");
    EXPECT_EQ(r.exit_code, 4) << r.err;
    EXPECT_EQ(bytes_of(in("old.exr")), "old");
}

TEST_F(Render, FocusesOnWhatThePictureShows) {
    scene();
    for (const char* at : {"-1,2", "2,-1", "1e9,2", "17,2", "2,10"}) {
        refused(render("x.exr", {"--spp", "1", "--size", "16x9", "--f-number", "2", "--focus-at", at}),
                ExitCode::wrong_arguments, "--focus-at: outside the picture (got ");
    }
}

TEST_F(Render, TooLargeIsFiveAndSaysHowMuch) {
    scene();
    // 65536^2 pixels with three double sums each take at least 103 GB.
    const Words words = render("x.exr", {"--spp", "1", "--size", "65536x65536"});
    refused(words, ExitCode::out_of_memory, "MB of memory");
    refused(words + Words{"--halves", "--spp", "2"}, ExitCode::wrong_arguments, "--spp");  // given twice
    refused(render("x.exr", {"--spp", "2", "--size", "65536x65536", "--halves"}), ExitCode::out_of_memory,
            "x.exr");
}

TEST_F(Render, ResumeWithoutAnythingToGoOnFromBeginsAnewAndSaysSo) {
    const Outcome fresh = run(render("a.exr", {"--spp", "8"}));
    ASSERT_EQ(fresh.exit_code, 0) << fresh.err;
    EXPECT_TRUE(fresh.err.empty()) << fresh.err;
    const Outcome r = run(render("b.exr", {"--spp", "8", "--resume"}));
    EXPECT_EQ(r.exit_code, 0);
    EXPECT_NE(r.err.find("warning"), std::string::npos) << r.err;
    EXPECT_NE(r.err.find("b.partial.exr"), std::string::npos) << r.err;
    EXPECT_EQ(read_image(in("a.exr")).rgb, read_image(in("b.exr")).rgb);
}

// A render that takes some seconds on one thread, and is interrupted before its end.
class RenderInterrupted : public Render {
  protected:
    Words slow(const std::string& output, const Words& more = {}) {
        return render(output, Words{"--size", "160x120", "--spp", "256", "--seed", "3", "--quiet"} + more);
    }
    void interrupt(const Words& words, int signal = SIGINT, int code = 130) {
        const pid_t child = begin(words + Words{"--threads", "1"});
        wait_for_handler(child);
        wait_for_work(child, std::chrono::milliseconds(120) * slower);
        ASSERT_EQ(::kill(child, signal), 0);
        const auto asked = std::chrono::steady_clock::now();
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFEXITED(status));
        ASSERT_EQ(WEXITSTATUS(status), code) << "0: it was done before it could be stopped";
        const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - asked).count();
        EXPECT_LT(took_s, 2.0 * slower);
    }
};

TEST_F(RenderInterrupted, ABatchSystemsSignalAsksToBeTakenUpAgain) {
    ASSERT_NO_FATAL_FAILURE(interrupt(slow("x.exr"), SIGTERM, 75));
    ASSERT_NO_FATAL_FAILURE(interrupt(slow("x.exr", {"--resume", "--requeue-code", "99"}), SIGUSR1, 99));
    EXPECT_TRUE(fs::exists(in("x.partial.exr")));
    EXPECT_FALSE(fs::exists(in("x.exr")));
}

TEST_F(RenderInterrupted, GoesOnToTheSameBits) {
    ASSERT_NO_FATAL_FAILURE(interrupt(slow("x.exr", {"--halves"})));
    EXPECT_FALSE(fs::exists(in("x.exr")));
    ASSERT_TRUE(fs::exists(in("x.partial.exr")));
    EXPECT_EQ(folder_.file_count(), 2U);                    // with the scene
    const Image partial = read_image(in("x.partial.exr"));  // a normal image
    EXPECT_EQ(partial.width, 160);
    EXPECT_GT(*std::max_element(partial.rgb.begin(), partial.rgb.end()), 0.1F);
    // The resumed run is interrupted once more.
    ASSERT_NO_FATAL_FAILURE(interrupt(slow("x.exr", {"--halves", "--resume"})));
    ASSERT_TRUE(fs::exists(in("x.partial.exr")));
    const Outcome resumed = run(slow("x.exr", {"--halves", "--resume", "--json"}));
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    const json j = json::parse(resumed.out);
    EXPECT_TRUE(j.at("warnings").empty()) << resumed.out;
    EXPECT_LT(j.at("rays").at("eye"), 160 * 120 * 256);  // the run did not start anew
    EXPECT_FALSE(fs::exists(in("x.partial.exr")));
    ASSERT_EQ(run(slow("y.exr", {"--halves"})).exit_code, 0);
    // Compares images instead of files, because files contain the time of writing.
    for (const char* ending : {".exr", ".a.exr", ".b.exr"}) {
        const Image x = read_image(in(std::string("x") + ending)),
                    y = read_image(in(std::string("y") + ending));
        EXPECT_TRUE(x.rgb == y.rgb) << ending;
    }
}

TEST_F(RenderInterrupted, OtherSettingsAndDamageAreThree) {
    const ExitCode three = ExitCode::invalid_input;
    ASSERT_NO_FATAL_FAILURE(interrupt(slow("x.exr")));
    const std::string whole = bytes_of(in("x.partial.exr"));
    ASSERT_FALSE(whole.empty());
    const auto resume = [&](const Words& more) {
        return Words{"render", in("scene.toml"), "-o", in("x.exr"), "--quiet", "--resume"} + more;
    };
    const auto settings = [](const char* spp, const char* seed, const char* size, const char* shutter) {
        return Words{"--spp", spp, "--seed", seed, "--size", size, "--shutter", shutter};
    };
    for (const Words& other :
         {settings("255", "3", "160x120", "0:1"), settings("256", "4", "160x120", "0:1"),
          settings("256", "3", "120x160", "0:1"), settings("256", "3", "160x120", "0:0.5"),
          settings("256", "3", "160x120", "0:1") + Words{"--halves"},
          settings("256", "3", "160x120", "0:1") + Words{"--f-number", "2.1"},
          settings("256", "3", "160x120", "0:1") + Words{"--sampler", "jittered"},
          settings("256", "3", "160x120", "0:1") + Words{"--shutter-curve", "triangle"},
          settings("256", "3", "160x120", "0:1") + Words{"--max-depth", "4"}})
        refused(resume(other), three, "other settings");
    refused(resume(settings("256", "4", "160x120", "0:1")), three,
            "x.partial.exr: cannot go on from this file: it was made with other settings: seed (got 3; "
            "expected 4) (without");
    const Words same = settings("256", "3", "160x120", "0:1");
    const auto damaged = [&](const std::string& bytes) {
        std::ofstream(in("x.partial.exr"), std::ios::binary) << bytes;
        refused(resume(same), three, "x.partial.exr");
        EXPECT_EQ(bytes_of(in("x.partial.exr")), bytes) << "it should be left for its owner";
    };
    for (const double share : {0.0, 0.001, 0.3, 0.9, 0.9999})
        damaged(whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    for (const double share : {0.1, 0.5, 0.99}) {
        std::string flipped = whole;
        char& byte = flipped[static_cast<std::size_t>(share * static_cast<double>(whole.size()))];
        byte = static_cast<char>(byte ^ 0x04);
        damaged(flipped);
    }
    damaged("no picture at all");
    // A finished image of this program is not accepted.
    ASSERT_EQ(run(render("z.exr", {"--spp", "1", "--size", "160x120", "--quiet"})).exit_code, 0);
    damaged(bytes_of(in("z.exr")));
    // A changed scene with the same name is not accepted.
    std::ofstream(in("x.partial.exr"), std::ios::binary) << whole;
    std::ofstream(in("scene.toml"), std::ios::app) << "# changed\n";
    refused(resume(same), three, "other settings");
    // Without --resume, the render starts anew.
    EXPECT_EQ(run(render("x.exr", {"--spp", "1", "--quiet"})).exit_code, 0);
    EXPECT_FALSE(fs::exists(in("x.partial.exr")));
}

}  // namespace
}  // namespace postlens::test::render_command_test
