// Blur by the lens and the shutter together.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <string>

#include "focus/focus.h"
#include "motionblur/motion_blur.h"
#include "motionblur/paths/paths_file.h"
#include "planner/auto_picture.h"
#include "planner/hybrid.h"
#include "records/sample_file.h"
#include "tests/planner/bar_scene.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/motion_frame.h"
#include "tests/support/reference.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::shoot_test {
namespace {

using glm::dvec3;

struct Shot {
    explicit Shot(const SceneBuilder& b, const TraceSettings& trace) : frame(b.scene, trace) {}
    TracedFrame frame;
    FrameMotion motion = motion_of(frame.file().header(), {});
    [[nodiscard]] HybridSettings settings(double focus_m, int views) const {
        HybridSettings s = test::settings(focus_m, views);
        s.motion = &motion;
        s.shutter = TimeSpan{0, 1};
        return s;
    }
};

TEST(Shoot, WithNothingThatMovesItIsTheLightField) {
    const SceneBuilder b = bar_and_wall();
    const Shot shot(b, traced(true));
    FocusSettings f = settings(3, 64).focus;
    f.method = FocusMethod::lightfield;
    EXPECT_EQ(hybrid_picture(shot.frame.file(), shot.settings(3, 64)).focus.image.rgb,
              focus_picture(shot.frame.file(), f).image.rgb);
}

// One bar crosses the defocused wall, another moves through the focus. Blurring first by the lens and then by
// motion, or in the other order, has a much larger error.
TEST(Shoot, LensAndShutterAtOnceAreWhatRaysSee) {
    SceneBuilder b = bar_and_wall();
    b.scene.objects[0].keys = from_to({0.35, 0, 0});
    Object& through = b.add(board(0.1, 0.25, -0.2, 0.2, 4), glowing({0.1, 0.8, 0.3}));
    through.id = 3;
    through.keys = from_to({0, 0, 2.5});
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    const HybridSettings s = shot.settings(2.5, 512);
    const Image truth = rays(b.scene, s), got = hybrid_picture(shot.frame.file(), s).focus.image;
    EXPECT_GT(psnr(got, truth), 38);
    HybridSettings still = s;
    still.shutter.reset();
    still.motion = nullptr;
    EXPECT_LT(psnr(hybrid_picture(shot.frame.file(), still).focus.image, truth), 30);
}

// An occluder of a light is used at its recorded position, but for a moving one the views give its position.
TEST(Shoot, AStillLampShinesPastAMovingBar) {
    SceneBuilder b = bar_and_wall();
    b.scene.objects[0].keys = from_to({0.35, 0, 0});
    b.add(board(-0.1, 0.1, -0.1, 0.1, 8), glowing({30, 20, 10})).id = 4;
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    const HybridSettings s = shot.settings(0.7, 512);
    const Image truth = rays(b.scene, s), got = hybrid_picture(shot.frame.file(), s).focus.image;
    // With the bar's shadow at its recorded position it would be 29.0 dB.
    EXPECT_GT(psnr(got, truth), 33.5);
}

// The floor at the lower border passes the plane of the camera, so it may come from anywhere.
TEST(Shoot, ACameraMayDrivePastWhatTheBorderShows) {
    SceneBuilder b = bar_and_wall();
    b.add(Plane{{0, -0.2, 0}, {0, 1, 0}}, glowing({0.4, 0.5, 0.2})).id = 3;
    b.scene.cameras[0].keys = from_to({0, 0, -0.95});
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    HybridSettings s = shot.settings(2.5, 64);
    s.scene = &b.scene;
    // 37.6 dB measured; 64 rays a pixel have 39.2.
    EXPECT_GT(psnr(hybrid_picture(shot.frame.file(), s).focus.image, rays(b.scene, s)), 37);
}

double sum(const Image& image) {
    double out = 0;
    for (const float v : image.rgb) out += static_cast<double>(v);
    return out;
}

/// A light that moves diagonally by 14 px, up from below the middle and towards the camera, in front of a
/// uniform wall.
SceneBuilder moving_light() {
    SceneBuilder b;
    b.add(board(-90, 90, -90, 90, 10), glowing({0.2, 0.2, 0.2}));
    Object& lamp = b.add(board(-0.43, -0.39, -0.22, -0.18, 4), glowing({60, 40, 20}));
    lamp.id = 2;
    lamp.keys = from_to({0.5, 0.35, 1});
    return b;
}

// A light is a dot in every view. Its streak must be uniform for any number of views, with and without
// defocus.
TEST(Shoot, AMovingLampIsAStreakForAnyNumberOfViews) {
    const SceneBuilder b = moving_light();
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    for (const double focus_m : {3.4, 1.5}) {
        const Image truth =
                        rendered_within(b.scene, by_rays(shot.settings(focus_m, 1), 16384), {16, 16, 24, 16}),
                    few = hybrid_picture(shot.frame.file(), shot.settings(focus_m, 16)).focus.image,
                    many = hybrid_picture(shot.frame.file(), shot.settings(focus_m, 512)).focus.image;
        EXPECT_NEAR(sum(few) / sum(truth), 1, 0.01) << focus_m;
        EXPECT_NEAR(sum(many) / sum(truth), 1, 0.01) << focus_m;
        // Measured: 43.9 and 45.4 dB for one focus, 46.5 and 50.5 dB for the other.
        EXPECT_GT(psnr(few, truth), 43.3) << focus_m;
        EXPECT_GT(psnr(many, truth), 44.8) << focus_m;
    }
}

// Without subdivision, the streak has an error that neither views nor rays reduce. No views are added that
// only reduce the noise, which is far smaller.
TEST(Shoot, AutoStopsWhereHighlightsMissTheTarget) {
    const SceneBuilder b = moving_light();
    TraceSettings trace = traced(true, 0);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    FocusFrame frame(shot.frame.file(), true);
    AutoSettings s{.hybrid = shot.settings(3.4, 1), .target_db = 70};
    s.hybrid.scene = &b.scene;
    const AutoResult r = auto_picture(frame, s);
    EXPECT_FALSE(r.met);
    EXPECT_LE(r.hybrid.focus.views, 32) << r.plan;  // 128 for half of the error that the target allows
    ASSERT_FALSE(r.hybrid.focus.warnings.empty());
    EXPECT_EQ(r.hybrid.focus.warnings.back().code, "target");
    EXPECT_NE(r.hybrid.focus.warnings.back().text.find("highlights have an error of "), std::string::npos)
        << r.hybrid.focus.warnings.back().text;
}

// In focus, a piece of a light is smaller than a pixel and in motion lies across the border of pixels.
TEST(Shoot, AMovingLampInFocusHasTheEdgesOfItsWay) {
    SceneBuilder b;
    b.add(board(-90, 90, -90, 90, 10), glowing({0.2, 0.2, 0.2}));
    Object& light = b.add(board(-0.47, -0.35, -0.05, 0.07, 4), glowing({20, 15, 10}));
    light.id = 2;
    light.keys = from_to({0.5, 0.06, 0});
    TraceSettings trace = traced(true, 5);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    HybridSettings s = shot.settings(4, 64);
    s.focus.lens.f_number = std::numeric_limits<double>::infinity();
    const Image truth = rendered_within(b.scene, by_rays(s, 4096), {8, 16, 48, 16}),
                got = hybrid_picture(shot.frame.file(), s).focus.image;
    RecordProperty("db", std::to_string(psnr(got, truth)));
    EXPECT_GT(psnr(got, truth), 45);  // 46.1 measured
}

// The records miss light of a moving source beside the light that they have. The check rays must find it.
TEST(Shoot, TheErrorOfAMovingLampIsStated) {
    for (const int levels : {2, 4}) {
        SceneBuilder b;
        b.add(board(-90, 90, -90, 90, 10), glowing({0.2, 0.2, 0.2}));
        Object& light = b.add(Sphere{{-0.4, 0.02, -4}, 0.07}, glowing({20, 15, 10}));
        light.id = 2;
        light.keys = from_to({0.8, 0.06, 0});
        TraceSettings trace = traced(true, levels);
        trace.for_shutter = TimeSpan{0, 1};
        const Shot shot(b, trace);
        HybridSettings s = shot.settings(4, 128);
        s.focus.lens.f_number = std::numeric_limits<double>::infinity();
        s.scene = &b.scene;
        const HybridResult got = hybrid_picture(shot.frame.file(), s);
        ASSERT_TRUE(got.stated);
        const double measured =
            encoded_psnr_db(got.focus.image, rendered_within(b.scene, by_rays(s, 8192), {12, 16, 40, 16}));
        EXPECT_GT(measured, got.stated->low_db()) << levels;
        EXPECT_LT(measured, got.stated->high_db()) << levels;
    }
}

// A bar in front of the light's path hides the light for a while, at a different time for each lens point.
TEST(Shoot, AMovingLampPassesBehindABar) {
    SceneBuilder b = moving_light();
    b.add(board(-0.09, -0.04, -3, 3, 1.2), glowing({0.1, 0.1, 0.1})).id = 3;
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    const HybridSettings s = shot.settings(2, 256);
    const Image truth = rendered_within(b.scene, by_rays(s, 16384), {16, 0, 24, 48}),
                got = hybrid_picture(shot.frame.file(), s).focus.image;
    EXPECT_NEAR(sum(got) / sum(truth), 1, 0.02);
    EXPECT_GT(psnr(got, truth), 42);  // 42.9 measured
}

// The light moves through the position of the lens, and leaves the image before. The result must be finite,
// with no more light than rays see.
TEST(Shoot, AMovingLampMayPassTheCamera) {
    SceneBuilder b = moving_light();
    b.scene.objects[1].keys = from_to({0.41, 0.2, 5});
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    const HybridSettings s = shot.settings(2, 64);
    const Image got = hybrid_picture(shot.frame.file(), s).focus.image, truth = rays(b.scene, s, 4096);
    for (const float v : got.rgb) ASSERT_TRUE(v >= 0 && std::isfinite(v));
    EXPECT_NEAR(sum(got) / sum(truth), 1, 0.05);
}

/// The frame's records with the colours of an image, as a start for blurring a blurred image again.
class Recoloured {
  public:
    Recoloured(const SampleFileReader& file, const Image& image) {
        SampleHeader h = file.header();
        h.subdivide_levels = 0;
        h.has_layers = h.has_w = h.has_bend = h.has_marks = false;
        h.overscan_px = 0;
        h.key_times_s.clear();
        RecordBand from, to;
        file.read(0, h.height + 1, from);
        to.x_end = h.width + 1;
        to.y_end = h.height + 1;
        for (int y = 0; y <= h.height; ++y) {
            for (int x = 0; x <= h.width; ++x) {
                Record r = from.records[from.offsets[from.pixel(x, y)]];
                r.r = mean(image, x, y, 0);
                r.g = mean(image, x, y, 1);
                r.b = mean(image, x, y, 2);
                r.mark = 0;
                to.records.push_back(r);
                to.offsets.push_back(static_cast<std::uint32_t>(to.records.size()));
            }
        }
        SampleFileWriter writer(folder_.path() / "recoloured.exr", h, RecordCompression::none);
        writer.write(to);
        writer.finish();
        file_ = std::make_unique<SampleFileReader>(folder_.path() / "recoloured.exr");
    }
    [[nodiscard]] const SampleFileReader& file() const { return *file_; }

  private:
    /// Mean of the four pixels around a corner.
    static float mean(const Image& image, int x, int y, std::size_t channel) {
        float sum = 0;
        for (int k = 0; k < 4; ++k) {
            sum += image.pixel(std::clamp(x - (k & 1), 0, image.width - 1),
                               std::clamp(y - (k >> 1), 0, image.height - 1))[channel];
        }
        return sum / 4;
    }
    TemporaryFolder folder_;
    std::unique_ptr<SampleFileReader> file_;
};

// A post passes in front of a far, defocused wall. At each instant, different lens points see different parts
// of the wall; an image that is already blurred has lost this information.
TEST(Shoot, BlurringTwiceIsWrongInEitherOrder) {
    SceneBuilder b = bar_and_wall();
    b.scene.objects[0].keys = from_to({0.5, 0, 0});
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    const Shot shot(b, trace);
    const SampleFileReader& file = shot.frame.file();
    const HybridSettings s = shot.settings(1, 512);
    const Image truth = rays(b.scene, s);
    const double at_once = psnr(hybrid_picture(file, s).focus.image, truth);

    const MotionBlurSettings moved{.exposure = {0, 1}, .method = MotionMethod::lightfield};
    FocusSettings f = s.focus;
    f.method = FocusMethod::layers;
    const Recoloured shutter_first(file, motion_blur(file, moved).image);
    const double then_lens = psnr(focus_picture(shutter_first.file(), f).image, truth);
    f.method = FocusMethod::lightfield;
    const Recoloured lens_first(file, focus_picture(file, f).image);
    const double then_shutter = psnr(motion_blur(lens_first.file(), moved).image, truth);
    RecordProperty("at_once_db", std::to_string(at_once));
    RecordProperty("shutter_then_lens_db", std::to_string(then_lens));
    RecordProperty("lens_then_shutter_db", std::to_string(then_shutter));
    EXPECT_GT(at_once, 40);
    EXPECT_LT(then_lens, at_once - 10);
    EXPECT_LT(then_shutter, at_once - 10);
}

// Records of one instant say what a surface reflects and transmits then. A tinted sheet that slides over a
// striped wall takes nothing of it along.
TEST(Shoot, RaysSeeWhatMovesInGlassAndMirrors) {
    for (const bool glass : {true, false}) {
        SceneBuilder b = bar_and_wall();
        Material m;
        m.emission = dvec3(0.05);
        (glass ? m.transmission : m.reflection) = dvec3(0.8, 0.5, 0.5);
        Object& sheet = b.add(board(-0.4, 0.1, -0.3, 0.3, 3), m);
        sheet.id = 3;
        sheet.keys = from_to({0.6, 0, 0});
        // Behind the camera, for the mirror: a striped wall that stays.
        for (int i = -40; i < 40; i += 2) {
            b.add(board(i * 0.35, i * 0.35 + 0.35, -9, 9, -6), glowing({0.1, 0.8, 0.3})).id = 4;
        }
        TraceSettings trace = traced(true);
        trace.for_shutter = TimeSpan{0, 1};
        const Shot shot(b, trace);
        HybridSettings s = shot.settings(2.5, 128);
        s.scene = &b.scene;
        const Image truth = rays(b.scene, s, 2048);
        const HybridResult got = hybrid_picture(shot.frame.file(), s);
        EXPECT_GT(psnr(got.focus.image, truth), psnr(rays(b.scene, s, 128, true), truth) - 0.5) << glass;
        EXPECT_LT(got.retraced_share, 0.6) << glass;
    }
}

TEST(Shoot, KeysCarryWhatTurns) {
    SceneBuilder b = bar_and_wall();
    Object& turning = b.add(Box{{-0.3, -0.3, -0.3}, {0.3, 0.3, 0.3}}, glowing({0.1, 0.8, 0.3}));
    turning.id = 3;
    turning.keys = {
        {.time_s = 0, .translation = dvec3(0.2, 0, -3)},
        {.time_s = 1, .translation = dvec3(0.2, 0, -3), .rotation = glm::angleAxis(0.8, dvec3(0, 1, 0))}};
    TraceSettings trace = traced(true);
    trace.for_shutter = TimeSpan{0, 1};
    trace.keys = 3;
    const Shot shot(b, trace);
    const HybridSettings s = shot.settings(3, 256);
    EXPECT_GT(psnr(hybrid_picture(shot.frame.file(), s).focus.image, rays(b.scene, s)), 33);
}

}  // namespace
}  // namespace postlens::test::shoot_test
