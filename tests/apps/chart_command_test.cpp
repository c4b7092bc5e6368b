// The command `chart`: the files it writes, resuming after an interruption, and arguments it rejects.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command_test.h"

namespace postlens::test::chart_command_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* scene_text =
    "[scene]\nambient_light = 0\n[[camera]]\nfocal_length_mm = 50\nf_number = 1\nfocus_m = 4\n"
    "[[material]]\nname = \"near\"\nambient = 0\ndiffuse = 0\nemission = [0.9, 0.3, 0.1]\n"
    "[[material]]\nname = \"far\"\nambient = 0\ndiffuse = 0\nemission = [0.1, 0.4, 0.8]\n"
    "[[object]]\nname = \"wall\"\nshape = \"rectangle\"\nmaterial = \"far\"\ncorner_m = [-9, -9, -4]\n"
    "edge_u_m = [18, 0, 0]\nedge_v_m = [0, 18, 0]\n"
    "[[object]]\nname = \"bar\"\nshape = \"rectangle\"\nmaterial = \"near\"\ncorner_m = [-0.1, -2, -1]\n"
    "edge_u_m = [0.2, 0, 0]\nedge_v_m = [0, 4, 0]\n";

class ChartCommand : public CommandTest {
  protected:
    void SetUp() override { std::ofstream(in("scene.toml")) << scene_text; }
    std::vector<std::string> words(const std::string& rays) {
        return {"chart",
                in("scene.toml"),
                "-o",
                in("chart"),
                "--size",
                "48x27",
                "--rays",
                rays,
                "--views",
                "4",
                "--depths",
                "4",
                "--rounds",
                "1",
                "--reference-spp",
                "16",
                "--json"};
    }
};

TEST_F(ChartCommand, FillsAFolder) {
    const Outcome r = run(words("1,4"));
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json j = json::parse(r.out);
    EXPECT_EQ(j["kept"], 0);
    EXPECT_EQ(j["points"].back()["name"], "rays spp=4");
    for (const json& p : j["points"]) {
        const bool shares = !p["trace"].get<std::string>().empty() && p["curve"] != "pinhole";
        EXPECT_EQ(p["further_s"].size(), shares ? 1 : 0) << p["name"];
    }
    for (const char* name : {"index.html", "chart.csv", "chart.json", "chart.md", "speed_accuracy.svg",
                             "speed_accuracy.png", "speed_accuracy_affected.svg", "cost.svg", "cost.png"})
        EXPECT_GT(fs::file_size(in("chart/") + name), 200) << name;
    // The gnuplot script can be run again in its folder.
    EXPECT_EQ(
        std::system(
            ("cd " + quoted(in("chart")) + " && rm cost.svg && gnuplot cost.gp && test -s cost.svg").c_str()),
        0);
}

TEST_F(ChartCommand, WhatNoLensCanBeIsRefusedBeforeAnythingIsWritten) {
    const std::vector<std::vector<std::string>> cases{
        {"--f-number", "-1"}, {"--f-number", "0"},  {"--focal-length", "0"},
        {"--focus", "-2"},    {"--shutter", "1:0"}, {"--f-number", "1e300", "--focal-length", "1e-300"},
        {"--rays", "0"}};
    for (const auto& options : cases) {
        std::vector<std::string> all = words("1");
        if (options[0] == "--rays") all = words("0");
        if (options[0] != "--rays") all.insert(all.end(), options.begin(), options.end());
        refused(all, ExitCode::wrong_arguments, options[0]);
        EXPECT_FALSE(fs::exists(in("chart"))) << options[0];
    }
    std::vector<std::string> pinhole = words("1");
    pinhole.insert(pinhole.end(), {"--f-number", "inf"});
    refused(pinhole, ExitCode::wrong_arguments, "--f-number");
}

TEST_F(ChartCommand, GoesOnAfterAnInterruption) {
    std::vector<std::string> long_work = words("1,4,262144");
    const pid_t child = fork();
    if (child == 0) {
        std::vector<char*> argv{const_cast<char*>(POSTLENS_BINARY)};
        for (std::string& w : long_work) argv.push_back(w.data());
        argv.push_back(nullptr);
        const int null = open("/dev/null", O_WRONLY);
        dup2(null, STDOUT_FILENO);
        dup2(null, STDERR_FILENO);
        execv(POSTLENS_BINARY, argv.data());
        _exit(127);
    }
    const auto written = [&] {
        const std::string path = in("chart/chart.json");
        return fs::exists(path) ? json::parse(bytes_of(path), nullptr, false) : json();
    };
    const auto finished = [&] {
        const json j = written();
        std::size_t count = 0;
        if (j.is_object()) {
            for (const json& p : j["points"]) count += p["seconds"].size();
        }
        return count;
    };
    // Waits for all points but the last, which would take minutes.
    std::size_t all = 0;
    for (int i = 0; i < 1200; ++i) {
        const json j = written();
        if (j.is_object()) all = j["points"].size();
        if (all > 0 && finished() == all - 1) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    ASSERT_GT(all, 5);
    kill(child, SIGINT);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 130);
    ASSERT_EQ(finished(), all - 1);
    const json before = json::parse(bytes_of(in("chart/chart.json")));
    const Outcome r = run(words("1,4"));
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const json after = json::parse(r.out);
    EXPECT_EQ(after["kept"], all - 1);
    for (std::size_t i = 0; i + 1 < all; ++i)
        EXPECT_EQ(after["points"][i]["seconds"], before["points"][i]["seconds"]);
}

TEST_F(ChartCommand, TakesNamesThatAreNotUtf8) {
    std::vector<std::string> latin1 = words("1");
    latin1[1] = in("sc\xe8ne.toml");
    std::ofstream(latin1[1]) << scene_text;
    latin1.emplace_back("--no-plots");
    const Outcome first = run(latin1), again = run(latin1);
    ASSERT_EQ(first.exit_code, 0) << first.err;
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out)["kept"], json::parse(first.out)["points"].size());
}

TEST_F(ChartCommand, RefusesInOneLine) {
    const auto refused = [&](std::vector<std::string> more, int code, const std::string& says) {
        std::vector<std::string> w = words("1");
        w.insert(w.end(), more.begin(), more.end());
        const Outcome r = run(w);
        EXPECT_EQ(r.exit_code, code) << r.err;
        EXPECT_NE(r.err.find(says), std::string::npos) << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
    };
    refused({"--f-number", "inf"}, 2, "nothing blurs");
    refused({"--rounds", "0"}, 2, "--rounds");
    refused({"--noise", "x.exr"}, 2, "--reference");
    refused({"--reference", in("none.exr")}, 3, "none.exr");
    std::vector<std::string> file = words("1");
    std::ofstream(in("file")) << "x";
    file[3] = in("file");
    Outcome r = run(file);
    EXPECT_EQ(r.exit_code, 4) << r.err;
    file[3] = in("no/such/folder");
    r = run(file);
    EXPECT_EQ(r.exit_code, 4) << r.err;
    std::vector<std::string> bad = words("1,x");
    EXPECT_EQ(run(bad).exit_code, 2);
    // A damaged chart is reported as damaged.
    fs::create_directory(in("chart"));
    std::ofstream(in("chart/chart.json")) << "{\"key\": ";
    refused({}, 3, "chart.json");
}

constexpr const char* case_text =
    "title = \"A near bar\"\nset = \"check\"\ncause = \"hidden-surface\"\nwhy = \"w\"\ndetection = "
    "\"d\"\noutcome = \"o\"\n"
    "[view]\nscene = \"../scene.toml\"\nsize_px = [48, 27]\nf_number = 1\nfocus_m = 4\nreference_spp = 32\n"
    "[method]\nname = \"lightfield\"\nviews = 16\nat_least_db = 10\nat_most_db = 90\nenergy_within = 0.5\n"
    "warnings = [\"uncovered\"]\ntrace = { hidden_layers = 0 }\n";

class AtlasCommand : public CommandTest {
  protected:
    void SetUp() override {
        std::ofstream(in("scene.toml")) << scene_text;
        fs::create_directory(in("cases"));
        write(case_text);
    }
    void write(const std::string& text) { std::ofstream(in("cases/bar.toml")) << text; }
    Outcome atlas() { return run({"chart", "--atlas", in("cases"), "-o", in("atlas"), "--json"}); }
};

TEST_F(AtlasCommand, MakesItsDocumentsAndKeepsWhatIsFinished) {
    Outcome r = atlas();
    ASSERT_EQ(r.exit_code, 0) << r.err << r.out;
    EXPECT_EQ(json::parse(r.out)["kept"], 0);
    EXPECT_EQ(json::parse(r.out)["cases"][0]["method"]["warnings"][0], "uncovered");
    const std::string page = bytes_of(in("atlas/failures.md"));
    EXPECT_NE(page.find("images/failures/bar.png"), std::string::npos);
    EXPECT_NE(page.find(" % of the pixels differ from the pinhole image; "), std::string::npos) << page;
    EXPECT_NE(page.find(" % of the squared error comes from surfaces that the sample file lacks.*\n"),
              std::string::npos)
        << page;
    EXPECT_NE(bytes_of(in("atlas/index.html")).find("data:image/png;base64,"), std::string::npos);
    EXPECT_GT(fs::file_size(in("atlas/images/failures/bar.png")), 200);
    EXPECT_FALSE(fs::exists(in("atlas/cases/bar.exr")));
    // Changed texts and bounds do not require a new image. The exit code reports a bound that is not met.
    std::string text = case_text;
    text.replace(text.find("at_least_db = 10"), 16, "at_least_db = 80");
    write(text);
    r = atlas();
    EXPECT_EQ(r.exit_code, 1);
    EXPECT_EQ(json::parse(r.out)["kept"], 1);
    EXPECT_NE(json::parse(r.out)["broken"][0].get<std::string>().find("bar: lightfield: PSNR"),
              std::string::npos);
    // A changed lens requires a new image.
    text.replace(text.find("f_number = 1"), 12, "f_number = 2");
    write(text);
    EXPECT_EQ(json::parse(atlas().out)["kept"], 0);
}

TEST_F(AtlasCommand, RefusesInOneLine) {
    const auto refused = [&](const std::string& what, const std::string& by, const std::string& says) {
        std::string text = case_text;
        text.replace(text.find(what), what.size(), by);
        write(text);
        const Outcome r = atlas();
        EXPECT_EQ(r.exit_code, 3) << r.err;
        EXPECT_NE(r.err.find(says), std::string::npos) << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
    };
    refused("hidden-surface", "hidden surface", "hidden-surface");
    refused("lightfield", "convolve", "bar.toml:");
    refused("at_most_db = 90\n", "", "at_most_db");
    refused("views", "vews", "views");
    refused("../scene.toml", "../none.toml", "none.toml");
    EXPECT_EQ(run({"chart", "--atlas", in("none"), "-o", in("atlas")}).exit_code, 3);
    EXPECT_EQ(run({"chart", "-o", in("atlas")}).exit_code, 2);
}

}  // namespace
}  // namespace postlens::test::chart_command_test
