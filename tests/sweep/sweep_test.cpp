// Sweeps: lists and ranges, equality with images of single calls, the table, and images kept from an earlier
// run.
#include "sweep/sweep.h"

#include <chrono>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <thread>

#include "core/error.h"
#include "core/files/text_file.h"
#include "core/job.h"
#include "core/threads.h"
#include "planner/hybrid.h"
#include "sweep/contact_sheet.h"
#include "sweep/figures.h"
#include "sweep/values.h"
#include "tests/support/motion_frame.h"

namespace postlens::test::sweep_test {
namespace {

using glm::dvec3;

/// Two planes, a mirror ball and a light that is bright enough to be a highlight.
SceneBuilder some_scene() {
    SceneBuilder b;
    b.add(board(-0.3, 0.02, -0.3, 0.3, 1.5), glowing({0.8, 0.3, 0.1}));
    b.add(board(0.2, 0.24, -0.1, -0.05, 1.2), glowing({30, 20, 10}));
    b.add(Sphere{{0.3, 0.15, -2}, 0.2}, mirror(0.8));
    for (int i = -5; i < 5; ++i) b.add(board(i * 0.7, i * 0.7 + 0.35, -5, 5, 4.9), glowing({0.7, 0.7, 0.6}));
    b.add(board(-9, 9, -9, 9, 5), glowing({0.1, 0.2, 0.4}));
    return b;
}

TraceSettings some_trace() {
    TraceSettings s;
    s.for_f_number = 1;
    s.hidden_layers = 1;
    s.overscan_px = 12;
    return s;
}

Impulse hexagon() {
    Impulse out;
    out.kind = ImpulseKind::polygon;
    return out;
}

void expect_refused(const std::function<void()>& call, const std::string& part) {
    try {
        call();
        ADD_FAILURE() << "not refused: " << part;
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::wrong_arguments) << e.what();
        EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
}

TEST(SweepValues, StopsAreExactPowersOfWhatTheyBeginWith) {
    const std::vector<double> n = f_number_list("--f-number", "1.4:16:1/2");
    ASSERT_EQ(n.size(), 15U);
    for (std::size_t i = 0; i < n.size(); ++i)
        EXPECT_DOUBLE_EQ(n[i], 1.4 * std::pow(2, static_cast<double>(i) / 4));
    // f/11 stands for f/11.31, which is 1/12 stop beyond it.
    EXPECT_NEAR(f_number_list("--f-number", "2:11:1").back(), 8 * std::sqrt(2), 1e-12);
    EXPECT_EQ(f_number_list("--f-number", "2:10:1").back(), 8);
    EXPECT_EQ(f_number_list("--f-number", "4:4:1"), (std::vector<double>{4}));
    EXPECT_EQ(f_number_list("--f-number", "2.8,inf"), (std::vector<double>{2.8, HUGE_VAL}));
}

TEST(SweepValues, FocusGoesEvenlyInDioptresEitherWay) {
    EXPECT_EQ(focus_list("--focus", "1:inf:3"), (std::vector<double>{1, 2, HUGE_VAL}));
    const std::vector<double> back = focus_list("--focus", "8:2:4");  // 1/8, 2/8, 3/8, 4/8
    ASSERT_EQ(back.size(), 4U);
    EXPECT_EQ(back.front(), 8);
    EXPECT_DOUBLE_EQ(back[1], 4);
    EXPECT_DOUBLE_EQ(back[2], 8.0 / 3);
    EXPECT_EQ(back.back(), 2);
    const std::vector<double> lengths = focal_length_list("--focal-length", "25:100:3");
    EXPECT_NEAR(lengths[1], 50, 1e-12);
}

TEST(SweepValues, WhatIsNoListIsRefusedByName) {
    for (const char* text :
         {"", "1.4,", "x", "0", "-2", "nan", "1.4:16", "1.4:16:1:2", "1.4:16:x", "1:2:1/0"})
        EXPECT_THROW(static_cast<void>(f_number_list("--f-number", text)), Error) << text;
    const auto f = [](const char* text) {
        return [text] { static_cast<void>(f_number_list("--f-number", text)); };
    };
    expect_refused(f("16:1.4:1"), "backwards");
    expect_refused(f("1.4:16:0"), "step out of range");
    expect_refused(f("2,4,2"), "twice");
    expect_refused(f("1:1000:1e-9"), "too many");
    const auto s = [](const char* text) {
        return [text] { static_cast<void>(focus_list("--focus", text)); };
    };
    expect_refused(s("1:5:0"), "empty range");
    expect_refused(s("1:5:1"), "empty range");
    expect_refused(s("3:3:4"), "empty range");
    expect_refused(s("1:5:1e9"), "too many");
    expect_refused(s("1:5:2.5"), "not a range");
    expect_refused([] { static_cast<void>(focal_length_list("--focal-length", "50,inf")); }, "not a number");
    expect_refused([] { static_cast<void>(shutter_list("--shutter", "0:1,1:0")); }, "closes before");
    expect_refused([] { static_cast<void>(shutter_list("--shutter", "0:1,0:1")); }, "twice");
    expect_refused([] { static_cast<void>(shutter_list("--shutter", "1")); }, "not two instants");
    EXPECT_EQ(shutter_list("--shutter", "0:0.5,0:1").size(), 2U);
}

TEST(SweepValues, ACommaBeforeAKindBeginsTheNextImpulse) {
    const std::vector<Impulse> i = impulse_list("--impulse", "disc,diffraction:450,550,polygon:5");
    ASSERT_EQ(i.size(), 3U);
    EXPECT_EQ(i[1].wavelengths_nm, (std::vector<double>{450, 550}));
    EXPECT_EQ(i[2].blades, 5);
    expect_refused([] { static_cast<void>(impulse_list("--impulse", "disc,disc")); }, "twice");
    expect_refused([] { static_cast<void>(impulse_list("--impulse", "star")); }, "star");
}

TEST(SweepGrid, FocusVariesFastestAndNamesTellAllApart) {
    const SweepGrid g = sweep_grid({.impulses = {Impulse{}, hexagon()},
                                    .shutters = {{0, 1.0000001}, {0, 1}},
                                    .focal_lengths_mm = {50},
                                    .f_numbers = {1.4, 2, 2.8},
                                    .focus_m = {1, 1.00001}});
    ASSERT_EQ(g.pictures.size(), 24U);
    EXPECT_EQ(g.row, 2U);
    EXPECT_EQ(g.pictures[1].focus_m, 1.00001);
    EXPECT_EQ(g.pictures[2].f_number, 2);
    EXPECT_EQ(g.pictures[6].shutter->close_s, 1);
    EXPECT_EQ(g.pictures[12].impulse.kind, ImpulseKind::polygon);
    std::vector<std::string> names;
    for (const SweepSetting& s : g.pictures) names.push_back(s.name);
    std::sort(names.begin(), names.end());
    EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
    EXPECT_EQ(sweep_grid({.focal_lengths_mm = {50}, .f_numbers = {1.4}, .focus_m = {5}}).pictures[0].name,
              "f1.4_s5");
    SweepAxes many{.focal_lengths_mm = {50}};
    for (int i = 1; i <= 400; ++i) {
        many.f_numbers.push_back(i);
        many.focus_m.push_back(i);
    }
    expect_refused([&] { static_cast<void>(sweep_grid(many)); }, "160000");
    expect_refused([] { static_cast<void>(sweep_grid({.focal_lengths_mm = {50}, .focus_m = {1}})); },
                   "--f-number");
}

TEST(SweepGrid, NumbersStandWhereThePatternSays) {
    EXPECT_EQ(numbered_name("pull.%04d", 7), "pull.0007");
    EXPECT_EQ(numbered_name("%dx", 12), "12x");
    for (const char* bad : {"pull", "%d%d", "%4d", "%0d", "%04x", "%00d", "%012d"})
        EXPECT_FALSE(numbered_name(bad, 1)) << bad;
}

// An image does not depend on the images made before. Lenses for which the light is a highlight, and others,
// alternate.
TEST(PictureMaker, SameBitsAsSingleCalls) {
    const TracedFrame frame(some_scene().scene, some_trace());
    for (const FocusMethod method : {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield,
                                     FocusMethod::hybrid, FocusMethod::pinhole}) {
        PictureMaker maker(frame.file(), {.method = method}, false);
        for (const auto& [f_number, focus_m, impulse] : {std::tuple{1.0, 1.5, Impulse{}},
                                                         {8.0, 1.2, Impulse{}},
                                                         {1.0, 1.5, hexagon()},
                                                         {double{HUGE_VAL}, 1.5, Impulse{}},
                                                         {1.4, 5.0, Impulse{}}}) {
            const FocusSettings alone{.lens = {.focal_length_mm = 50, .f_number = f_number},
                                      .focus_distance_m = focus_m,
                                      .method = method,
                                      .impulse = impulse};
            const bool hybrid = method == FocusMethod::hybrid && std::isfinite(f_number);
            const Image expected = hybrid ? hybrid_picture(frame.file(), {.focus = alone}).focus.image
                                          : focus_picture(frame.file(), alone).image;
            const MadePicture got = maker.make(
                {.impulse = impulse, .focal_length_mm = 50, .f_number = f_number, .focus_m = focus_m});
            EXPECT_EQ(got.image.rgb, expected.rgb) << method_name(method) << " f/" << f_number;
        }
    }
}

TEST(PictureMaker, SameBitsAsShootAndAsMotionBlurAlone) {
    SceneBuilder b = some_scene();
    b.scene.objects[0].keys = from_to({0.3, 0, 0});
    TraceSettings trace = some_trace();
    trace.for_shutter = TimeSpan{0, 1};
    const TracedFrame frame(b.scene, trace);
    PictureMaker maker(frame.file(), {.views = 16}, true);
    const FrameMotion motion = motion_of(frame.file().header(), {});
    for (const TimeSpan& shutter : {TimeSpan{0, 1}, TimeSpan{0.2, 0.4}}) {
        const Image both = hybrid_picture(frame.file(), {.focus = {.lens = {50, 1.4},
                                                                   .focus_distance_m = 1.5,
                                                                   .method = FocusMethod::lightfield,
                                                                   .views = 16},
                                                         .motion = &motion,
                                                         .shutter = shutter})
                               .focus.image;
        SweepSetting s{.shutter = shutter, .focal_length_mm = 50, .f_number = 1.4, .focus_m = 1.5};
        EXPECT_EQ(maker.make(s).image.rgb, both.rgb);
        s.f_number = HUGE_VAL;
        const MadePicture moving = maker.make(s);
        EXPECT_EQ(moving.method, "motionblur");
        EXPECT_EQ(moving.image.rgb,
                  motion_blur(frame.file(), {.exposure = {shutter.open_s, shutter.close_s}, .views = 16})
                      .image.rgb);
    }
    EXPECT_THROW(PictureMaker(frame.file(), {.method = FocusMethod::scatter}, true), Error);
}

class SweepFolder : public testing::Test {
  protected:
    SweepFolder() { trace_to_file(some_scene().scene, some_trace(), path_ / "frame.exr"); }
    SweepResult run(const SweepSettings& s) { return sweep(path_ / "frame.exr", s, path_ / "out"); }
    [[nodiscard]] Image picture(const std::string& name) const { return read_image(path_ / "out" / name); }
    static SweepSettings two_by_two() {
        SweepSettings s;
        s.axes = {.focal_lengths_mm = {50}, .f_numbers = {1.4, HUGE_VAL}, .focus_m = {1.5, 5}};
        return s;
    }
    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_.path();
};

TEST_F(SweepFolder, TellsOfEveryPictureWhatTheLensDoes) {
    SweepSettings s = two_by_two();
    s.picture.method = FocusMethod::scatter;
    s.at = {{20.5, 24.5}, {2.5, 2.5}};  // the near board and the far boards
    const SweepResult r = run(s);
    ASSERT_EQ(r.table.rows.size(), 4U);
    EXPECT_EQ(r.made, 4U);
    // The CoC is d / pitch F / n |1/s - 1/z'|, with d = F = 50 mm.
    const double across = px_per_m * 0.05 / 1.4;
    EXPECT_NEAR(r.table.rows[0].coc_px[0], 0, 1e-9 * across);
    EXPECT_NEAR(r.table.rows[0].coc_px[1], across * (1 / 1.5 - 1 / 4.9), 0.02 * across);  // 4.9 or 5 m
    EXPECT_NEAR(r.table.rows[1].coc_px[0], across * (1 / 5.0 - 1 / 1.5), 1e-6);
    // The largest CoC is that of the light at 1.2 m. A mirror counts with the depth of its surface.
    EXPECT_NEAR(r.table.rows[1].largest_coc_px, across * (1 / 1.2 - 1 / 5.0), 1e-6);
    EXPECT_GT(r.table.rows[0].in_focus_share, 0.05);
    EXPECT_LT(r.table.rows[0].in_focus_share, 0.5);
    EXPECT_GT(r.table.rows[1].in_focus_share, 0.3);
    for (const std::size_t pinhole : {2U, 3U}) {
        EXPECT_EQ(r.table.rows[pinhole].method, "pinhole");
        EXPECT_EQ(r.table.rows[pinhole].in_focus_share, 1);
        EXPECT_EQ(r.table.rows[pinhole].sharpness, 1);
    }
    EXPECT_LT(*r.table.rows[0].sharpness, 1);
    EXPECT_LT(*r.table.rows[0].sharpness, *r.table.rows[1].sharpness);  // the bars are far away
    const SampleFileReader file(path_ / "frame.exr");
    EXPECT_EQ(picture("f1.4_s1.5.exr").rgb,
              focus_picture(file, {.lens = {50, 1.4}, .focus_distance_m = 1.5}).image.rgb);
    const std::string csv = read_text_file(r.csv, 100000);
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
    EXPECT_EQ(csv.rfind("file,f_number,", 0), 0U);
    EXPECT_NE(csv.find("coc_px 20.5 24.5"), std::string::npos);
    EXPECT_NE(csv.find("finf_s5.exr,inf,50,5,,,disc,pinhole,0,"), std::string::npos) << csv;
    EXPECT_EQ(csv.find(",-0,"), std::string::npos) << csv;
    EXPECT_EQ(rows_of_json(read_text_file(r.json, 100000), "x").size(), 4U);
    EXPECT_GT(read_image_size(*r.contact_sheet).width, 128);
}

TEST_F(SweepFolder, SharpnessIsRelativeToThePinholeThatShowsTheSame) {
    SweepSettings s = two_by_two();
    s.axes = {.focal_lengths_mm = {50, 80}, .f_numbers = {HUGE_VAL}, .focus_m = {2}};
    for (const FocusMethod method : {FocusMethod::scatter, FocusMethod::lightfield}) {
        for (const Framing framing : {Framing::lens, Framing::breathing}) {
            s.picture = {.method = method, .framing = framing};
            const SweepResult r = run(s);
            for (const SweepRow& row : r.table.rows) EXPECT_NEAR(*row.sharpness, 1, 1e-9) << row.file;
        }
    }
}

TEST_F(SweepFolder, KeepsWhatIsStillAsItWasMade) {
    SweepSettings s = two_by_two();
    EXPECT_EQ(run(s).made, 4U);
    EXPECT_EQ(run(s).made, 4U);  // without `resume`, all images are made again
    s.resume = true;
    const std::string first = read_text_file(path_ / "out" / "contact.png", 10'000'000);
    const SweepResult again = run(s);
    EXPECT_EQ(again.kept, 4U);
    EXPECT_EQ(read_text_file(path_ / "out" / "contact.png", 10'000'000), first);
    EXPECT_LT(*again.table.rows[0].sharpness, 1);
    s.axes.f_numbers.push_back(4);
    EXPECT_EQ(run(s).made, 2U);
    std::ofstream(path_ / "out" / "f4_s5.exr") << "not a picture";
    std::filesystem::remove(path_ / "out" / "f1.4_s5.exr");
    EXPECT_EQ(run(s).made, 2U);
    s.picture.depths = 64;
    EXPECT_EQ(run(s).made, 6U);
    TraceSettings other = some_trace();
    other.overscan_px = 11;
    trace_to_file(some_scene().scene, other, path_ / "frame.exr");
    EXPECT_EQ(run(s).made, 6U);
    std::ofstream(path_ / "out" / "sweep.json") << "{\"pictures\": [{}]}";
    try {
        static_cast<void>(run(s));
        ADD_FAILURE() << "read a list that is none";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::invalid_input);
    }
}

TEST_F(SweepFolder, AnInterruptedSweepGoesOn) {
    SweepSettings s = two_by_two();
    for (int i = 0; i < 50; ++i) s.axes.focus_m.push_back(6 + i);
    Job job;
    std::thread canceller([&] {
        while (!std::filesystem::exists(path_ / "out" / "f1.4_s6.exr"))
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        job.cancel();
    });
    {
        const JobScope scope(job);
        try {
            static_cast<void>(run(s));
            ADD_FAILURE() << "not interrupted";
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::interrupted);
            EXPECT_NE(std::string(e.what()).find("--resume goes on"), std::string::npos) << e.what();
        }
    }
    canceller.join();
    EXPECT_FALSE(std::filesystem::exists(path_ / "out" / "sweep.csv"));
    for (const auto& entry : std::filesystem::directory_iterator(path_ / "out")) {  // all files are complete
        if (entry.path().extension() == ".exr") {
            EXPECT_EQ(read_image(entry.path()).width, 64);
        }
    }
    s.resume = true;
    const SweepResult r = run(s);
    EXPECT_GE(r.kept, 2U);
    EXPECT_LT(r.kept, 104U);
    EXPECT_EQ(r.kept + r.made, 104U);
}

TEST_F(SweepFolder, SameBitsForAnyNumberOfThreads) {
    SweepSettings s = two_by_two();
    s.picture.method = FocusMethod::lightfield;
    s.picture.views = 8;
    std::vector<Image> pictures;
    for (const int threads : {1, 4}) {
        const ThreadLimit limit(threads);
        static_cast<void>(run(s));
        pictures.push_back(picture("f1.4_s1.5.exr"));
        pictures.push_back(picture("contact.png"));
    }
    EXPECT_EQ(pictures[0].rgb, pictures[2].rgb);
    EXPECT_EQ(pictures[1].rgb, pictures[3].rgb);
}

TEST_F(SweepFolder, NumbersFramesAndRefusesBeforeItWrites) {
    SweepSettings s = two_by_two();
    s.format = "png";
    s.frames = "pull.%03d";
    EXPECT_EQ(run(s).table.rows[3].file, "pull.004.png");
    std::filesystem::remove_all(path_ / "out");
    s.frames = "pull";
    expect_refused([&] { static_cast<void>(run(s)); }, "--frames");
    s.frames = "../p%d";
    expect_refused([&] { static_cast<void>(run(s)); }, "--frames: names a folder (got ../p%d;");
    s.frames.reset();
    s.at = {{6, 1}, {5, 1}, {6, 1}};
    expect_refused([&] { static_cast<void>(run(s)); }, "--at: twice in the list (got 6,1;");
    s.at = {{64, 1}};
    expect_refused([&] { static_cast<void>(run(s)); }, "--at");
    s.at.clear();
    s.coc_limit_px = 0;
    expect_refused([&] { static_cast<void>(run(s)); }, "--coc-limit");
    s.coc_limit_px = 1;
    s.picture.framing = Framing::breathing;
    s.axes.focus_m = {5, 0.04};  // a focus distance below the focal length has no real image
    EXPECT_THROW(static_cast<void>(run(s)), Error);
    EXPECT_FALSE(std::filesystem::exists(path_ / "out"));
}

TEST(ContactSheet, EveryPixelOfASmallerPictureIsTheMeanOfWhatItCovers) {
    Image ramp(9, 5);
    for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 9; ++x) ramp.pixel(x, y)[0] = static_cast<float>(x + 10 * y);
    }
    const Image small = made_smaller(ramp, 4, 2);
    for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 4; ++x) {
            // The mean of the piecewise constant function over [a, b).
            const auto mean = [](int i, int to, int from) {
                const double a = static_cast<double>(i) * from / to,
                             b = static_cast<double>(i + 1) * from / to;
                double sum = 0;
                for (int k = 0; k < from; ++k)
                    sum += k * std::max(0.0, std::min(b, k + 1.0) - std::max(a, 1.0 * k));
                return sum / (b - a);
            };
            EXPECT_NEAR(static_cast<double>(small.pixel(x, y)[0]), mean(x, 4, 9) + 10 * mean(y, 2, 5), 1e-5);
        }
    }
    EXPECT_EQ(made_smaller(ramp, 9, 5).rgb, ramp.rgb);
}

TEST(ContactSheet, RowsOfAGridStayRows) {
    EXPECT_EQ(ContactSheet({960, 540}, std::vector<std::string>(64, "f/1.4"), 8).columns(), 8U);
    EXPECT_EQ(ContactSheet({960, 540}, std::vector<std::string>(48, "f/1.4"), 48).columns(), 7U);
    EXPECT_EQ(ContactSheet({960, 540}, {"f/1.4"}, 1).columns(), 1U);
    EXPECT_LE(ContactSheet({960, 540}, std::vector<std::string>(1024, "f/1.4"), 512).picture().width, 2500);
    EXPECT_LE(ContactSheet({5, 300}, {"f/1.4"}, 1).thumbnail().width, 5);
}

// A step of height h between two columns has an energy of h^2 per row.
TEST(Figures, TheEnergyOfAStepIsItsSquareTimesItsLength) {
    Image step(8, 6);
    for (int y = 0; y < 6; ++y) {
        for (int x = 4; x < 8; ++x) {
            for (int c = 0; c < 3; ++c) step.pixel(x, y)[c] = x == 7 ? 40.0F : 0.5F;
        }
    }
    // The steps are from 0 to 0.5 and to 1, because brighter values count as white.
    EXPECT_NEAR(gradient_energy(step), 6 * (0.25 + 0.25), 1e-6);
}

}  // namespace
}  // namespace postlens::test::sweep_test
