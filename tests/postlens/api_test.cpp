// The public interface: the same pictures, figures and errors as the command.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <postlens/compare.h>
#include <postlens/error.h>
#include <postlens/focus.h>
#include <postlens/frame.h>
#include <postlens/job.h>
#include <postlens/lens.h>
#include <postlens/motionblur.h>
#include <postlens/picture.h>
#include <postlens/render.h>
#include <postlens/shoot.h>
#include <postlens/sweep.h>
#include <postlens/trace.h>
#include <postlens/version.h>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "postlens/internals.h"
#include "tests/support/command_test.h"

namespace postlens::test::api_test {
namespace {

const std::string bars = POSTLENS_SAMPLES "/scenes/bars.toml",
                  motion = POSTLENS_SAMPLES "/scenes/motion.toml";
constexpr double infinity = std::numeric_limits<double>::infinity();

class Api : public CommandTest {
  protected:
    /// A small trace of a scene, for an aperture of f/1.4 and a shutter from 0 to 0.5 s.
    std::string traced(const std::string& scene = bars) {
        std::string path = in("frame.exr");
        (void)api::trace(scene, path,
                         {.size = api::Size{48, 27},
                          .for_f_number = 1.4,
                          .for_focus_distance_m = 2,
                          .for_shutter = api::Shutter{0, 0.5},
                          .subdivide = 0,
                          .overscan_px = api::automatic});
        return path;
    }
    std::string command(const std::vector<std::string>& words) {
        const Outcome r = run(words);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return r.out;
    }
    /// Expects that `call` throws an error with this code and one line of text that contains `part`.
    static void fails(api::ExitCode code, const std::string& part, const std::function<void()>& call) {
        try {
            call();
            ADD_FAILURE() << "no error (expected " << part << ")";
        } catch (const api::Error& e) {
            const std::string text = e.what();
            EXPECT_EQ(e.code(), code) << text;
            EXPECT_NE(text.find(part), std::string::npos) << text;
            EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 0) << text;
        }
    }
};

void expect_equal(const api::Picture& a, const api::Picture& b) {
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.exposure_stops, b.exposure_stops);
    EXPECT_TRUE(a.rgb == b.rgb);
}

TEST_F(Api, ATraceForRaysIsThatOfTheCommand) {
    const api::Size size{48, 27};
    const api::TraceResult fine = api::trace(bars, in("fine.exr"), {.size = size, .for_f_number = 1.4});
    const api::TraceResult coarse =
        api::trace(bars, in("coarse.exr"), {.size = size, .for_f_number = 1.4, .for_rays = true});
    EXPECT_LT(coarse.records, fine.records);
    command({"trace", bars, "-o", in("expected.exr"), "--size=48x27", "--for-f-number=1.4", "--for-rays"});
    EXPECT_EQ(bytes_of(in("coarse.exr")), bytes_of(in("expected.exr")));
}

TEST_F(Api, TraceAndFocusMakeTheCommandsFiles) {
    const std::string path = traced();
    command({"trace", bars, "-o", in("expected.exr"), "--size=48x27", "--for-f-number=1.4", "--for-focus=2",
             "--for-shutter=0:0.5", "--subdivide=0", "--overscan=auto"});
    EXPECT_EQ(bytes_of(path), bytes_of(in("expected.exr")));

    const api::Frame frame(path);
    for (const std::string method : {"scatter", "layers", "lightfield"}) {
        const api::FocusResult made = api::focus(
            frame, {.lens = {.focal_length_mm = 50, .f_number = 2, .focus_distance_m = 3}, .method = method});
        api::save_picture(in("a.exr"), made.picture);
        command({"focus", path, "-o", in("b.exr"), "--focal-length=50", "--f-number=2", "--focus=3",
                 "--method=" + method});
        EXPECT_EQ(bytes_of(in("a.exr")), bytes_of(in("b.exr"))) << method;
        EXPECT_EQ(made.method, method);
        EXPECT_EQ(made.f_number, 2);
        EXPECT_EQ(made.focus_distance_m, 3);
        EXPECT_GT(made.largest_coc_px.value_or(0), 0.5);
        EXPECT_NE(made.report.json.find("\"largest_coc_px\""), std::string::npos);
    }
}

TEST_F(Api, APictureKeepsAllItsValuesInAFile) {
    const api::Picture picture{.width = 2, .height = 1, .rgb = {0, 0.5, 1, 2, -1, 1e6F}, .exposure_stops = 2};
    api::save_picture(in("a.exr"), picture);
    const api::Picture read = api::load_picture(in("a.exr"));
    expect_equal(picture, read);
    api::save_picture(in("a.png"), picture);
    EXPECT_EQ(api::load_picture(in("a.png")).width, 2);
}

TEST_F(Api, AFrameSaysWhatTheFileHolds) {
    const api::Frame frame(traced());
    const api::FrameInfo& info = frame.info();
    EXPECT_EQ(info.kind, "samples");
    EXPECT_EQ(info.width, 48);
    EXPECT_EQ(info.height, 27);
    EXPECT_EQ(info.focal_length_mm, 50);
    EXPECT_EQ(info.instants_s.size(), 1U);
    EXPECT_FALSE(info.ids.empty());

    const api::Records records = frame.records();
    const std::size_t count = records.x.size();
    EXPECT_EQ(count, info.records);
    EXPECT_EQ(records.columns, 48 + 2 * info.overscan_px + 1);
    EXPECT_EQ(records.offsets.size(), static_cast<std::size_t>(records.rows * records.columns) + 1);
    EXPECT_EQ(records.offsets.back(), count);
    EXPECT_EQ(records.rgb.size(), 3 * count);
    EXPECT_EQ(records.w.size(), 4 * count);
    for (std::size_t i = 0; i < count; ++i) {
        // A surface that is seen directly: W = I / z'.
        if (records.path[i] != 0 || records.z[i] == infinity) continue;
        EXPECT_NEAR(records.w[4 * i] * records.z[i], 1, 1e-5);
    }
    fails(api::ExitCode::wrong_arguments, "no such instant", [&] { (void)frame.records(1); });
}

TEST_F(Api, RenderAndCompareAreTheCommands) {
    const api::RenderSettings settings{.spp = 4,
                                       .lens = {.f_number = 2, .focus_distance_m = 3},
                                       .size = api::Size{32, 18},
                                       .seed = 3,
                                       .halves = true};
    const api::RenderResult made = api::render(bars, settings);
    ASSERT_EQ(made.halves.size(), 2U);
    command({"render", bars, "-o", in("b.exr"), "--spp=4", "--f-number=2", "--focus=3", "--size=32x18",
             "--seed=3", "--halves"});
    expect_equal(made.picture, api::load_picture(in("b.exr")));

    const api::CompareResult same = api::compare(made.picture, api::load_picture(in("b.exr")));
    EXPECT_TRUE(same.identical);
    EXPECT_EQ(same.psnr_db, infinity);
    api::save_picture(in("a.exr"), made.halves[0]);
    const api::CompareResult differ = api::compare(in("a.exr"), in("b.exr"), {.fail_psnr_db = 100});
    EXPECT_FALSE(differ.identical);
    EXPECT_EQ(differ.report.exit_code, api::ExitCode::comparison_failed);
    EXPECT_EQ(differ.psnr_db, api::compare(made.halves[0], made.picture).psnr_db);
}

TEST_F(Api, MotionblurShootAndSweepAreTheCommands) {
    const api::Frame frame(traced(motion));
    const api::MotionBlurResult blurred = api::motionblur(frame, {.shutter = api::Shutter{0, 0.5}});
    command({"motionblur", frame.path().string(), "-o", in("b.exr"), "--shutter=0:0.5"});
    expect_equal(blurred.picture, api::load_picture(in("b.exr")));
    EXPECT_GT(blurred.touched_share, 0);

    const api::FocusResult shot = api::shoot(
        frame,
        {.lens = {.f_number = 2, .focus_distance_m = 2}, .shutter = api::Shutter{0, 0.5}, .views = 16});
    command({"shoot", frame.path().string(), "-o", in("c.exr"), "--f-number=2", "--focus=2",
             "--shutter=0:0.5", "--views=16"});
    expect_equal(shot.picture, api::load_picture(in("c.exr")));

    const api::SweepResult swept =
        api::sweep(frame.path(), in("sweep"),
                   {.f_number = {2, infinity}, .focus_distance_m = {1.5, 2}, .method = "scatter"});
    ASSERT_EQ(swept.pictures.size(), 4U);
    EXPECT_EQ(swept.made, 4);
    EXPECT_EQ(swept.pictures[2].f_number, infinity);
    EXPECT_EQ(swept.pictures[1].focus_distance_m, 2);
    EXPECT_TRUE(std::filesystem::exists(in("sweep") / swept.pictures[3].file));
}

TEST_F(Api, FiguresOfAThinLens) {
    const api::LensSettings lens{.focal_length_mm = 50, .f_number = 2, .focus_distance_m = 3};
    // c = (F / n) (V / s) (z - s) / z with V = F s / (s - F) [potmesil1981, eq. 1 and 3].
    const double v_mm = 50 * 3.0 / (3 - 0.05), expected_mm = 25 * (v_mm / 3000) * (6 - 3) / 6.0;
    EXPECT_NEAR(api::circle_of_confusion(lens, 6).coc_mm, expected_mm, 1e-9);
    const api::DepthOfField range = api::depth_of_field(lens, {.coc_limit_mm = 0.03});
    EXPECT_LT(range.near_m, 3);
    EXPECT_GT(range.far_m, 3);
    EXPECT_EQ(api::depth_of_field({.focal_length_mm = 50, .f_number = 2, .focus_distance_m = infinity}).far_m,
              infinity);

    const api::ImpulseResponse response =
        api::impulse_response({.lens = lens, .depth_m = 6, .pixel_pitch_um = 20, .size_px = 33});
    EXPECT_EQ(response.width, 33);
    double sum = 0;
    for (const float v : response.values) sum += static_cast<double>(v);
    EXPECT_NEAR(sum, response.energy_in_frame, 1e-4);
}

TEST_F(Api, ErrorsHaveTheCommandsCodeAndOneLine) {
    using Code = api::ExitCode;
    const api::Frame frame(traced());
    fails(Code::invalid_input, "no.exr", [&] { const api::Frame missing(in("no.exr")); });
    fails(Code::invalid_input, "no.toml", [&] { (void)api::render(in("no.toml"), {.spp = 1}); });
    fails(Code::wrong_arguments, "--spp", [&] { (void)api::render(bars, {}); });
    for (const double f_number : {std::numeric_limits<double>::quiet_NaN(), 0.0, -2.0})
        fails(Code::wrong_arguments, "--f-number",
              [&] { (void)api::focus(frame, {.lens = {.f_number = f_number}}); });
    fails(Code::wrong_arguments, "--method", [&] { (void)api::focus(frame, {.method = "no"}); });
    fails(Code::wrong_arguments, "--no-such", [&] { (void)api::focus(frame, {.options = {"--no-such"}}); });
    fails(Code::wrong_arguments, "--output", [] { (void)api::run({"render", bars, "--spp", "1"}); });
    fails(Code::wrong_arguments, "no path", [&] { const api::Frame nothing(""); });
    fails(Code::wrong_arguments, "rgb", [&] { api::save_picture(in("x.exr"), {.width = 2, .height = 2}); });
    fails(Code::cannot_write, "no/x.exr", [&] {
        api::save_picture(in("no/x.exr"), {.width = 1, .height = 1, .rgb = {0, 0, 0}});
    });
    fails(Code::wrong_arguments, "threads", [] { const api::Job job({.threads = -1}); });
    EXPECT_EQ(folder_.file_count(), 1U);  // the frame
    fails(Code::out_of_memory, "cannot start a thread", [] {
        try {
            throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
        } catch (...) {
            api::rethrow_as_error();
        }
    });
}

TEST_F(Api, AnotherThreadCancelsAJob) {
    std::atomic<bool> working = false;
    api::Job job({.threads = 2, .watch = [&](const api::Progress&) { working = true; }});
    std::thread canceller([&] {
        while (!working) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        job.cancel();
    });
    // All of its 10^9 rays would take minutes.
    fails(api::ExitCode::interrupted, "", [&] {
        (void)api::trace(
            bars, in("x.exr"),
            {.size = api::Size{512, 512}, .subdivide = 6, .threshold = 0, .options = {"--force"}}, &job);
    });
    canceller.join();
    EXPECT_TRUE(job.cancelled());
    EXPECT_EQ(folder_.file_count(), 0U);
    fails(api::ExitCode::interrupted, "", [&] { (void)api::render(bars, {.spp = 1}, &job); });
}

TEST_F(Api, TwoJobsInOneProcessMakeTheSameBitsOnAnyNumberOfThreads) {
    const std::string path = traced();
    const api::FocusSettings settings{
        .lens = {.f_number = 2, .focus_distance_m = 2}, .method = "lightfield", .views = 32};
    const api::Picture expected = api::focus(api::Frame(path), settings).picture;
    std::vector<api::Picture> made(2);
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < made.size(); ++i) {
        threads.emplace_back([&, i] {
            api::Job job({.threads = static_cast<int>(i) + 1});
            const api::Frame frame(path);
            for (int again = 0; again < 3; ++again) made[i] = api::focus(frame, settings, &job).picture;
        });
    }
    for (std::thread& t : threads) t.join();
    for (const api::Picture& picture : made) expect_equal(picture, expected);
}

TEST_F(Api, AnyCommandRuns) {
    const api::Report report = api::run({"lens", "show", POSTLENS_SAMPLES "/lenses/double_gauss.toml"});
    EXPECT_NE(report.json.find("\"efl_mm\""), std::string::npos);
    EXPECT_FALSE(report.text.empty());
    EXPECT_EQ(command({"--version"}), "postlens " + api::version() + "\n");
    EXPECT_NE(api::run({"focus", "--help"}).text.find("--f-number"), std::string::npos);
}

}  // namespace
}  // namespace postlens::test::api_test
