// Speed-accuracy charts: Pareto frontiers, plans, results kept between runs, and the page in a browser.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "chart/chart_data.h"
#include "chart/chart_page.h"
#include "chart/chart_plan.h"
#include "chart/chart_plots.h"
#include "chart/chart_runner.h"
#include "chart/earlier_chart.h"
#include "chart/gnuplot.h"
#include "chart/pareto.h"
#include "core/error.h"
#include "core/files/text_file.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::chart_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(Pareto, KeepsWhatNothingBeats) {
    const double nan = std::nan("");
    const std::vector<CostError> points{{1, 0.5},   {2, 0.1}, {2, 0.2}, {3, 0.1},
                                        {0.5, 0.9}, {4, nan}, {5, 0.05}};
    EXPECT_THAT(pareto_frontier(points), ElementsAre(4, 0, 1, 6));
    EXPECT_TRUE(pareto_frontier({}).empty());
}

TEST(Pareto, SecondsForAnErrorLieOnTheLineBetweenLogarithms) {
    // error = 1 / seconds^2, so error 0.04 takes 5 s. The dominated point must have no effect.
    const std::vector<CostError> curve{{1, 1}, {10, 0.01}, {100, 0.0001}, {50, 0.9}};
    EXPECT_NEAR(*seconds_for_error(curve, 0.04), 5, 1e-9);
    EXPECT_NEAR(*seconds_for_error(curve, 0.01), 10, 1e-12);
    EXPECT_FALSE(seconds_for_error(curve, 2).has_value());
    EXPECT_FALSE(seconds_for_error(curve, 1e-5).has_value());
}

TEST(ChartData, MedianOfFewTimes) {
    EXPECT_EQ(median({3, 1, 2}), 2);
    EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
    EXPECT_TRUE(std::isnan(median({})));
}

TEST(ChartData, ATraceIsSharedByItsPictures) {
    const ChartTrace trace{.name = "records", .seconds = {20}};
    const ChartPoint point{.name = "a", .trace = "records", .seconds = {1, 3, 2}};
    EXPECT_EQ(point.seconds_each(&trace, 10), 4);
    EXPECT_EQ(point.seconds_each(&trace, std::numeric_limits<double>::infinity()), 2);
    EXPECT_EQ(point.seconds_each(nullptr, 1), 2);
}

TEST(ChartData, PicturesOfASweepShareWhatNoLensChanges) {
    const ChartTrace trace{.name = "records", .seconds = {20}};
    const ChartPoint point{
        .name = "a", .trace = "records", .seconds = {2}, .first_of_many_s = {3}, .further_s = {0.5}};
    EXPECT_EQ(point.seconds_each(&trace, 1), 22);  // one image of the trace
    EXPECT_EQ(point.seconds_each(&trace, 10), 2.75);
    EXPECT_EQ(point.seconds_each(&trace, std::numeric_limits<double>::infinity()), 0.5);
}

Scene still(std::optional<double> f_number) {
    Scene out;
    out.cameras.push_back({.width = 32, .height = 18, .f_number = f_number, .focus_m = 2});
    out.cameras[0].focal_length_mm = 50;
    return out;
}

TEST(ChartPlan, AsksForWhatBlurs) {
    const auto names = [](const ChartRequest& r, const Scene& s) {
        std::vector<std::string> out;
        for (const PlannedPoint& p : chart_plan(r, chart_view(r, s)).points) out.push_back(p.curve);
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    };
    ChartRequest r;
    EXPECT_THAT(names(r, still(1.4)), ElementsAre("hybrid, coarse", "layers", "layers, coarse",
                                                  "layers, visible only", "lightfield", "lightfield, coarse",
                                                  "lightfield, visible only", "pinhole", "rays", "scatter"));
    r.shutter = TimeSpan{0, 1};
    EXPECT_THAT(names(r, still(1.4)), ElementsAre("hybrid, coarse", "lightfield", "lightfield, coarse",
                                                  "lightfield, visible only", "pinhole", "rays"));
    EXPECT_THAT(names(r, still(std::nullopt)),
                ElementsAre("auto", "convolve", "convolve, coarse", "convolve, visible only", "lightfield",
                            "pinhole", "rays"));
    r.shutter.reset();
    EXPECT_THROW((void)chart_view(r, still(std::nullopt)), Error);
    r.f_number = std::numeric_limits<double>::infinity();
    EXPECT_THROW((void)chart_view(r, still(1.4)), Error);
}

TEST(ChartPlan, TracesKnowTheLensByItsDiameter) {
    ChartRequest r;
    r.focal_length_mm = 100;  // an aperture twice as wide as that of the camera's 50 mm at the same f-number
    const Scene scene = still(2);
    const ChartPlan plan = chart_plan(r, chart_view(r, scene));
    EXPECT_NEAR(*plan.traces[0].settings.for_f_number, 1, 1e-12);
    EXPECT_EQ(plan.traces[1].settings.hidden_layers, 0);
}

TEST(ChartKey, KnowsTheReferenceByItsContents) {
    const TemporaryFolder folder;
    ChartRequest r;
    r.reference = folder.path() / "reference.exr";
    r.second_reference = folder.path() / "noise.exr";
    const Scene scene = still(1.4);
    const auto key_with = [&](const fs::path& path, const char* contents) {
        std::ofstream(path) << contents;
        return chart_key(r, chart_view(r, scene), scene);
    };
    std::ofstream(*r.second_reference) << "b";
    const std::string key = key_with(*r.reference, "a");
    EXPECT_THAT(key, HasSubstr(" f/1.4 "));
    EXPECT_NE(key_with(*r.reference, "c"), key);
    EXPECT_EQ(key_with(*r.reference, "a"), key);
    EXPECT_NE(key_with(*r.second_reference, "c"), key);
}

constexpr const char* two_boards =
    "[scene]\nambient_light = 0\n[[camera]]\nfocal_length_mm = 50\nf_number = 0.3\nfocus_m = 4\n"
    "[[material]]\nname = \"near\"\nambient = 0\ndiffuse = 0\nemission = [0.9, 0.3, 0.1]\n"
    "[[material]]\nname = \"far\"\nambient = 0\ndiffuse = 0\nemission = [0.1, 0.4, 0.8]\n"
    "[[object]]\nname = \"wall\"\nshape = \"rectangle\"\nmaterial = \"far\"\ncorner_m = [-9, -9, -4]\n"
    "edge_u_m = [18, 0, 0]\nedge_v_m = [0, 18, 0]\n"
    "[[object]]\nname = \"bar\"\nshape = \"rectangle\"\nmaterial = \"near\"\ncorner_m = [-0.1, -2, -1]\n"
    "edge_u_m = [0.2, 0, 0]\nedge_v_m = [0, 4, 0]\n";

class ChartRunTest : public testing::Test {
  protected:
    ChartRunTest() {
        std::ofstream(folder_ / "scene.toml") << two_boards;
        request_.scene = folder_ / "scene.toml";
        request_.camera.width = 48;
        request_.camera.height = 27;
        request_.spp = {1, 16};
        request_.views = {8};
        request_.depths = {4};
        request_.reference_spp = 64;
        request_.rounds = 2;
        request_.once_above_s = 1000;
    }
    [[nodiscard]] fs::path out() const { return folder_ / "chart"; }

    TemporaryFolder temporary_;
    fs::path folder_ = temporary_.path();
    ChartRequest request_;
};

TEST_F(ChartRunTest, MeasuresEverythingOnceAndKeepsIt) {
    const ChartRun first = run_chart(request_, out(), false);
    EXPECT_EQ(first.kept, 0);
    EXPECT_GT(first.data.affected_share, 0.1);
    ASSERT_TRUE(first.data.noise_rms.has_value());
    for (const ChartPoint& p : first.data.points) {
        ASSERT_TRUE(p.figures.has_value()) << p.name;
        EXPECT_EQ(p.seconds.size(), 2) << p.name;
        EXPECT_TRUE(fs::exists(out() / "pictures" / (point_file_name(p.name) + ".png"))) << p.name;
        EXPECT_TRUE(fs::exists(out() / "maps" / (point_file_name(p.name) + ".png"))) << p.name;
    }
    const auto psnr = [&](const std::string& name) {
        for (const ChartPoint& p : first.data.points) {
            if (p.name == name) return p.figures->whole.psnr_db;
        }
        ADD_FAILURE() << name;
        return 0.0;
    };
    // Every method is more accurate than the pinhole image, and 16 rays are more accurate than one.
    EXPECT_GT(psnr("layers"), psnr("pinhole") + 3);
    EXPECT_GT(psnr("lightfield M=8"), psnr("pinhole") + 3);
    EXPECT_GT(psnr("rays spp=16"), psnr("rays spp=1") + 6);

    // A second run measures only the additional setting.
    request_.spp = {1, 16, 4};
    const ChartRun second = run_chart(request_, out(), false);
    EXPECT_EQ(second.kept, 2 * first.data.points.size());
    for (std::size_t i = 0; i < first.data.points.size(); ++i)
        EXPECT_EQ(second.data.points[i].seconds, first.data.points[i].seconds);
    EXPECT_EQ(second.data.points.back().name, "rays spp=4");
    EXPECT_EQ(second.data.points.back().seconds.size(), 2);
    EXPECT_FALSE(fs::exists(out() / "frames"));

    // Without --restart, a chart of another lens is rejected.
    request_.f_number = 2;
    try {
        (void)run_chart(request_, out(), false);
        ADD_FAILURE();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::wrong_arguments);
        EXPECT_THAT(e.what(), HasSubstr("--restart"));
    }
    EXPECT_EQ(run_chart(request_, out(), true).kept, 0);
}

TEST_F(ChartRunTest, ReadsBackWhatItWrote) {
    request_.rounds = 1;
    const ChartRun run = run_chart(request_, out(), false);
    const std::string text = to_json(run.data).dump();
    EXPECT_EQ(to_json(chart_from_json(text, "chart.json")).dump(), text);
    EXPECT_THROW((void)chart_from_json("{\"key\": 3}", "chart.json"), Error);
    EXPECT_THROW((void)chart_from_json("[", "chart.json"), Error);
    const std::string csv = chart_csv(run.data);
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), static_cast<long>(run.data.points.size()) + 1);
    EXPECT_THAT(chart_markdown(run.data), HasSubstr("| rays spp=16 |"));
}

// Runs the page's code in a browser: moving the slider must change the visible parts of the images.
TEST_F(ChartRunTest, SliderOfThePageMoves) {
    if (std::system("chromium --version >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "no chromium to look at the page with";
    request_.rounds = 1;
    const ChartRun run = run_chart(request_, out(), false);
    if (std::system("gnuplot --version >/dev/null 2>&1") == 0) {
        draw_with_gnuplot(speed_accuracy_script(run.data, false), out() / "speed_accuracy", 800, 500);
        draw_with_gnuplot(cost_script(run.data), out() / "cost", 800, 500);
        EXPECT_THAT(read_text_file(out() / "speed_accuracy.svg", 1 << 24),
                    HasSubstr("noise of the reference"));
    }
    const std::string page = chart_page(run.data, out());
    const std::string driver = R"(<script>
      const shown = () => document.querySelector(".view .left").style.clipPath;
      const before = shown();
      by("slider").value = 250;
      by("slider").dispatchEvent(new Event("input"));
      const after = shown();
      by("left").value = "rays spp=1";
      by("left").dispatchEvent(new Event("change"));
      const left = document.querySelector(".view .left");
      const is_rays = left.src === data.pictures["rays spp=1"];
      by("kind").value = "maps";
      by("kind").dispatchEvent(new Event("change"));
      const is_map = left.src === data.maps["rays spp=1"];
      document.title = ["RESULT", before, after, is_rays, is_map, by("points").tBodies[0].rows.length].join("|");
    </script></body>)";
    std::string driven = page;
    driven.replace(driven.rfind("</body>"), 7, driver);
    std::ofstream(folder_ / "driven.html") << driven;
    const std::string command =
        "timeout 60 chromium --headless --no-sandbox --disable-gpu --user-data-dir=" +
        (folder_ / "browser").string() + " --virtual-time-budget=3000 --dump-dom file://" +
        (folder_ / "driven.html").string() + " 2>/dev/null >" + (folder_ / "dom").string();
    ASSERT_EQ(std::system(command.c_str()), 0);
    const std::string dom = read_text_file(folder_ / "dom", 1 << 28);
    EXPECT_THAT(dom, HasSubstr("<title>RESULT|inset(0px 50% 0px 0px)|inset(0px 75% 0px 0px)|true|true|" +
                               std::to_string(run.data.points.size()) + "</title>"));
    // The page loads nothing from the network.
    EXPECT_EQ(page.find("http://"), std::string::npos);
    EXPECT_EQ(page.find("https://"), std::string::npos);
}

TEST(ChartRequest, RefusesWhatIsOutOfRange) {
    const auto refused = [](auto change) {
        ChartRequest r;
        change(r);
        EXPECT_THROW(check_chart_request(r), Error);
    };
    refused([](ChartRequest& r) { r.spp = {0}; });
    refused([](ChartRequest& r) { r.views = {5000}; });
    refused([](ChartRequest& r) { r.depths = {1}; });
    refused([](ChartRequest& r) { r.rounds = 0; });
    refused([](ChartRequest& r) { r.reference_spp = 0; });
    refused([](ChartRequest& r) { r.once_above_s = std::nan(""); });
    refused([](ChartRequest& r) { r.second_reference = "b.exr"; });
    EXPECT_NO_THROW(check_chart_request({}));
}

}  // namespace
}  // namespace postlens::test::chart_test
