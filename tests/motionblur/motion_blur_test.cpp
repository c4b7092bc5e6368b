// Motion blur against closed forms, limiting cases and invariants.
#include "motionblur/motion_blur.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/threads.h"
#include "tests/motionblur/moving_scenes.h"
#include "tests/support/motion_frame.h"
#include "tracer/render.h"

namespace postlens::test::motion_blur_test {
namespace {

using glm::dvec3;

struct BarCase {
    double left, width, way;
};

class MovingBar : public testing::TestWithParam<BarCase> {};

// The bar's edges lie on borders of quadtree cells (1/4 px), so the records hold it exactly, except that a
// corner represents its surroundings up to 1/8 px.
TEST_P(MovingBar, IsATrapezoid) {
    const auto [left, width, way] = GetParam();
    const TracedFrame frame(bar(left, width, way), for_shutter());
    for (const MotionMethod method : {MotionMethod::convolve, MotionMethod::lightfield}) {
        const Image image = frame.blur(method).image;
        double worst = 0;
        for (int x = 0; x < image.width; ++x) {
            const double expected = pixel_mean(x, left, width, way);
            for (const int y : {3, 24, 40})
                worst = std::max(worst, std::abs(static_cast<double>(image.pixel(x, y)[0]) - expected));
        }
        // Each edge is known to 1/8 px, which changes the ramp of a motion by d px by 1/(8 d), or by 1/8
        // without motion. M views have an error of up to 1/M at each of two edges. i2 with c cells per pixel
        // displaces the ends of the ramp by half a cell, 1 / (2 c d).
        const double views = 2.0 / 128,
                     cells = method == MotionMethod::convolve ? 0.5 / std::max(way, 1.0) : 0;
        EXPECT_LE(worst, 2 * 0.125 / std::max(way, 1.0) + (method == MotionMethod::convolve ? cells : views))
            << static_cast<int>(method) << " way " << way;
    }
}

INSTANTIATE_TEST_SUITE_P(Widths, MovingBar,
                         testing::Values(BarCase{10, 8, 20}, BarCase{10, 20, 8}, BarCase{20, 2, 24},
                                         BarCase{12, 12, 12}, BarCase{20, 10, 3.5}, BarCase{20, 10, 0.75}));

TEST(MotionBlur, ConservesLightInsideTheFrame) {
    const Scene scene = bar(12, 6, 24);
    const TracedFrame frame(scene, for_shutter());
    const double still = light_of(frame.file().picture());
    // Tolerance: cells and coverage are floats.
    EXPECT_NEAR(light_of(frame.blur(MotionMethod::convolve).image), still, 1e-5 * still);
    // Each of 128 views counts the bar's columns to one column.
    EXPECT_NEAR(light_of(frame.blur(MotionMethod::lightfield).image), still, 0.01 * still);
}

TEST(MotionBlur, LightsOfRadianceFiftyKeepTheirSumAndCentre) {
    SceneBuilder b;
    Object& o = b.add(Disc{{-0.8, 0.3, -depth_m}, {0, 0, 1}, 0.05, 0}, glowing(dvec3(50)));
    o.keys = from_to({24 * m_per_px, -9 * m_per_px, 0});
    const TracedFrame frame(b.scene, for_shutter(4));
    const Image still = frame.file().picture(), image = frame.blur(MotionMethod::convolve).image;
    const auto centroid = [](const Image& i) {
        dvec3 sum(0);
        for (int y = 0; y < i.height; ++y) {
            for (int x = 0; x < i.width; ++x) {
                const auto v = static_cast<double>(i.pixel(x, y)[0]);
                sum += dvec3(v * x, v * y, v);
            }
        }
        return sum;
    };
    const dvec3 a = centroid(still), c = centroid(image);
    EXPECT_NEAR(c.z, a.z, 1e-5 * a.z);
    EXPECT_NEAR(c.x / c.z - a.x / a.z, 12, 0.01);
    EXPECT_NEAR(c.y / c.z - a.y / a.z, 4.5, 0.01);
}

TEST(MotionBlur, NothingMovingIsThePinholePicture) {
    SceneBuilder b;
    b.add(Sphere{{0, 0, -4}, 0.6}, glowing({0.2, 0.5, 0.9}));
    const TracedFrame frame(b.scene);
    for (const MotionMethod method :
         {MotionMethod::automatic, MotionMethod::convolve, MotionMethod::lightfield})
        EXPECT_TRUE(equal_bits(frame.blur(method).image, frame.file().picture()));
}

TEST(MotionBlur, ZeroExposureIsTheStillBitForBit) {
    const TracedFrame frame(bar(20, 10, 15), for_shutter());
    for (const MotionMethod method :
         {MotionMethod::automatic, MotionMethod::convolve, MotionMethod::lightfield})
        EXPECT_TRUE(equal_bits(frame.blur(method, 0, 0).image, frame.file().picture()));
}

TEST(MotionBlur, ZeroExposureAtAnotherInstantIsTheMovedStill) {
    const TracedFrame frame(bar(20, 10, 16), for_shutter());
    for (const MotionMethod method : {MotionMethod::convolve, MotionMethod::lightfield}) {
        const Image image = frame.blur(method, 0.5, 0.5).image;
        for (int x = 0; x < 64; ++x) {
            const double expected = x >= 28 && x < 38 ? 1 : 0;
            // The records hold each edge to 1/8 px.
            EXPECT_NEAR(static_cast<double>(image.pixel(x, 20)[0]), expected, 0.13) << x;
        }
    }
}

TEST(MotionBlur, CameraThatMovesWithItsObjectGivesNoBlurOfIt) {
    SceneBuilder b;
    const auto keys = std::vector<TransformKey>{
        {.time_s = 0},
        {.time_s = 1, .translation = {0.7, -0.2, 0.3}, .rotation = glm::angleAxis(0.3, dvec3(0, 1, 0))}};
    b.add(Rectangle{{-1, -1, -3}, {2, 0, 0}, {0, 2, 0}}, glowing({0.3, 0.6, 0.9})).keys = keys;
    b.scene.cameras[0].keys = keys;
    const TracedFrame frame(b.scene);
    for (const MotionMethod method : {MotionMethod::convolve, MotionMethod::lightfield}) {
        const MotionBlurResult r = frame.blur(method);
        const Image still = frame.file().picture();
        for (const ObjectReport& o : r.objects) {
            if (o.id != 1) continue;
            EXPECT_EQ(o.kind, MotionKind::still) << o.largest_move_px;
        }
        for (int y = 8; y < 40; ++y) {
            for (int x = 8; x < 56; ++x) EXPECT_EQ(r.image.pixel(x, y)[1], still.pixel(x, y)[1]);
        }
    }
}

TEST(MotionBlur, ObjectsThatMoveAlikeAreOneAndTheSameAsOneObject) {
    // A plate, and the same plate cut in two parts with equal motion, which must have no seam.
    SceneBuilder whole, halves;
    const auto keys = from_to({18 * m_per_px, 5 * m_per_px, 0});
    whole.add(Rectangle{{-1, -0.8, -4}, {1.5, 0, 0}, {0, 1.5, 0}}, glowing(dvec3(0.8))).keys = keys;
    halves.add(Rectangle{{-1, -0.8, -4}, {0.61, 0, 0}, {0, 1.5, 0}}, glowing(dvec3(0.8))).keys = keys;
    halves.add(Rectangle{{-0.39, -0.8, -4}, {0.89, 0, 0}, {0, 1.5, 0}}, glowing(dvec3(0.8))).keys = keys;
    const TracedFrame a(whole.scene, for_shutter()), b(halves.scene, for_shutter());
    const MotionBlurResult one = a.blur(MotionMethod::convolve), two = b.blur(MotionMethod::convolve);
    for (std::size_t i = 0; i < one.image.rgb.size(); ++i)
        EXPECT_NEAR(one.image.rgb[i], two.image.rgb[i], 1e-5) << i;
}

TEST(MotionBlur, LongExposureWeighsTheStandstillAtTheEnds) {
    // The shutter is open from -1 s to 3 s, and the motion lasts from 0 s to 1 s. For a quarter of the
    // exposure the bar is at its start, and for half of it at its end.
    const TracedFrame frame(bar(8, 8, 32), for_shutter());
    for (const MotionMethod method : {MotionMethod::convolve, MotionMethod::lightfield}) {
        const Image image = frame.blur(method, -1, 3).image;
        EXPECT_NEAR(static_cast<double>(image.pixel(11, 20)[0]), 0.25 + 0.25 * trapezoid(11.5, 8, 8, 32),
                    0.02);
        EXPECT_NEAR(static_cast<double>(image.pixel(44, 20)[0]), 0.5 + 0.25 * trapezoid(44.5, 8, 8, 32),
                    0.02);
        EXPECT_NEAR(static_cast<double>(image.pixel(28, 20)[0]), 0.25 * trapezoid(28.5, 8, 8, 32), 0.02);
    }
}

TEST(MotionBlur, OutAndBackIsTwiceTheWayAtTwiceTheSpeed) {
    const std::vector<TransformKey> keys{
        {.time_s = 0}, {.time_s = 0.5, .translation = {20 * m_per_px, 0, 0}}, {.time_s = 1}};
    const TracedFrame there(bar(14, 6, 20), for_shutter()), back(bar(14, 6, 0, keys), for_shutter());
    for (const MotionMethod method : {MotionMethod::convolve, MotionMethod::lightfield}) {
        const Image a = there.blur(method).image, b = back.blur(method).image;
        // Paths of 20 px have cells of 1/4 px, paths of 40 px cells of 1/2 px. The ends differ by half of the
        // difference.
        const double ends = 2 * 0.125 / 20, views = 4.0 / 128;
        for (int x = 0; x < 64; ++x)
            EXPECT_NEAR(a.pixel(x, 20)[0], b.pixel(x, 20)[0], method == MotionMethod::convolve ? ends : views)
                << x;
    }
}

TEST(MotionBlur, ViewsAreCountedByTheWholePath) {
    // Sixteen times 40 px, so that 320 views are needed for one per 2 px.
    std::vector<TransformKey> keys;
    for (int i = 0; i <= 16; ++i)
        keys.push_back({.time_s = i / 16.0, .translation = {i % 2 * 40 * m_per_px, 0, 0}});
    const TracedFrame frame(bar(4, 6, 0, keys), for_shutter());
    EXPECT_EQ(frame.blur(MotionMethod::lightfield).views, 521);
}

TEST(MotionBlur, LeavesAndReentersTheFrame) {
    // The bar leaves the frame on the right and returns. It is visible for about the first and the last
    // third.
    const std::vector<TransformKey> keys{
        {.time_s = 0}, {.time_s = 0.5, .translation = {40 * m_per_px, 0, 0}}, {.time_s = 1}};
    const TracedFrame frame(bar(40, 12, 0, keys), for_shutter());
    const Image a = frame.blur(MotionMethod::convolve).image, b = frame.blur(MotionMethod::lightfield).image;
    for (int x = 0; x < 64; ++x) {
        const double expected = pixel_mean(x, 40, 12, 40);
        EXPECT_NEAR(static_cast<double>(a.pixel(x, 20)[0]), expected, 0.02) << x;
        EXPECT_NEAR(static_cast<double>(b.pixel(x, 20)[0]), expected, 0.03) << x;
    }
}

TEST(MotionBlur, WhatIsUncoveredIsRightWhereRecordedAndSaidWhereNot) {
    const Scene scene = plate_over_wall();
    RenderSettings truth;
    truth.spp = 1024;
    truth.shutter = TimeSpan{0, 1};
    const Image reference = render_picture(scene, truth).image;
    TraceSettings without = for_shutter(6);
    without.for_shutter.reset();
    const TracedFrame known(scene, for_shutter(6)), unknown(scene, without);
    for (const MotionMethod method : {MotionMethod::convolve, MotionMethod::lightfield}) {
        const MotionBlurResult right = known.blur(method), filled = unknown.blur(method);
        EXPECT_FALSE(has_warning(right, "uncovered"));
        EXPECT_TRUE(has_warning(filled, "uncovered"));
        // The study reports 42.6 dB against 26.9 dB; here the records hold edges to 1/128 px.
        EXPECT_GT(psnr(right.image, reference), 40) << static_cast<int>(method);
        EXPECT_LT(psnr(filled.image, reference), psnr(right.image, reference) - 8);
    }
}

TEST(MotionBlur, SameBitsForAnyNumberOfThreads) {
    const TracedFrame frame(plate_over_wall(), for_shutter());
    for (const MotionMethod method : {MotionMethod::convolve, MotionMethod::lightfield}) {
        Image first;
        for (const int threads : {1, 5}) {
            const ThreadLimit limit(threads);
            const Image image = frame.blur(method).image;
            if (threads == 1) first = image;
            EXPECT_TRUE(equal_bits(first, image)) << threads;
        }
    }
}

TEST(MotionBlur, PathsReplaceWhatTheFileSays) {
    const TracedFrame frame(bar(20, 8, 20), for_shutter());
    ObjectPath path;
    path.ids = {1};
    path.source = "test:1";
    path.motion = ScreenPath(PathKind::polyline,
                             {{.time_s = 0, .at_px = {5, 5}}, {.time_s = 1, .at_px = {-7, 5}}}, "test");
    for (const MotionMethod method : {MotionMethod::convolve, MotionMethod::lightfield}) {
        const Image image =
            motion_blur(frame.file(), {.exposure = {0, 1}, .method = method, .paths = {path}}).image;
        for (int x = 0; x < 64; ++x) {  // mirrored, because the bar moves by 12 px to the left
            EXPECT_NEAR(static_cast<double>(image.pixel(x, 20)[0]), pixel_mean(63 - x, 64 - 28, 8, 12), 0.06)
                << x;
        }
    }
    path.ids = {9};
    EXPECT_THROW(static_cast<void>(motion_blur(frame.file(), {.exposure = {0, 1}, .paths = {path}})), Error);
}

TEST(MotionBlur, FittedPathsKeepWithinTheirTolerance) {
    std::vector<TransformKey> keys;
    for (int i = 0; i <= 60; ++i) {
        const double t = i / 60.0;
        keys.push_back(
            {.time_s = t, .translation = {20 * m_per_px * t * t, 8 * m_per_px * std::sin(3 * t), 0}});
    }
    const TracedFrame frame(bar(14, 6, 0, keys), for_shutter());
    const MotionBlurResult exact = frame.blur(MotionMethod::convolve);
    const MotionBlurResult fitted =
        motion_blur(frame.file(), {.exposure = {0, 1}, .method = MotionMethod::convolve, .fit_px = 0.1});
    ASSERT_EQ(fitted.objects.size(), 1U);
    EXPECT_LE(fitted.objects[0].fit_error_px, 0.1);
    EXPECT_GE(fitted.objects[0].fitted_knots, 2U);
    EXPECT_LE(fitted.objects[0].fitted_knots, 8U);
    for (std::size_t i = 0; i < exact.image.rgb.size(); ++i)
        EXPECT_NEAR(exact.image.rgb[i], fitted.image.rgb[i], 0.1);
}

TEST(MotionBlur, SaysWhatItCannotShow) {
    SceneBuilder b;
    b.add(Rectangle{{-3, -1, -8}, {6, 0, 0}, {0, 0, 7}}, matte(dvec3(0.7)));  // floor
    b.add(Sphere{{-0.8, 0, -5}, 0.5}, matte({0.9, 0.3, 0.2})).keys = from_to({0.8, 0, 0});
    b.add(Rectangle{{-2, -1, -7}, {4, 0, 0}, {0, 3, 0}}, mirror());
    b.point_light({0.5, 4, -3});
    const TracedFrame frame(b.scene, for_shutter());
    const MotionBlurResult r = frame.blur(MotionMethod::automatic);
    EXPECT_TRUE(has_warning(r, "reflection"));
    EXPECT_TRUE(has_warning(r, "shadow"));
    EXPECT_FALSE(has_warning(r, "light"));
    b.scene.lights[0].keys = from_to({1, 0, 0});
    EXPECT_TRUE(has_warning(TracedFrame(b.scene, for_shutter()).blur(MotionMethod::automatic), "light"));
}

TEST(MotionBlur, SaysWhoseShadingChanges) {
    for (const bool casts_shadows : {false, true}) {
        SceneBuilder b = lit_plate();
        b.scene.lights[0].casts_shadows = casts_shadows;
        const TracedFrame frame(b.scene, for_shutter());
        const MotionBlurResult passes = frame.blur(MotionMethod::automatic);
        EXPECT_TRUE(has_warning(passes, "light"));
        EXPECT_EQ(has_warning(passes, "shadow"), casts_shadows);
        // At 2 s the plate has arrived: its shading and shadow differ from those recorded at 0 s all the
        // same.
        const MotionBlurResult later = frame.blur(MotionMethod::automatic, 2, 3);
        EXPECT_TRUE(has_warning(later, "light"));
        EXPECT_EQ(has_warning(later, "shadow"), casts_shadows);
        EXPECT_TRUE(frame.blur(MotionMethod::automatic, 0, 0).warnings.empty());
    }
    // A far light sees the plate move, but from one direction.
    SceneBuilder far = lit_plate();
    far.scene.lights[0].position = {3, 90, 60};
    EXPECT_FALSE(has_warning(TracedFrame(far.scene, for_shutter()).blur(MotionMethod::automatic), "light"));
}

TEST(MotionBlur, RefusesWhatMakesNoSense) {
    const TracedFrame frame(bar(20, 8, 20));
    const double nan = std::nan(""), inf = HUGE_VAL;
    for (const Exposure e : {Exposure{1, 0}, Exposure{nan, 1}, Exposure{0, inf}, Exposure{-inf, 0}})
        EXPECT_THROW(static_cast<void>(motion_blur(frame.file(), {.exposure = e})), Error);
    for (const double px : {0.0, -1.0, nan, inf})
        EXPECT_THROW(static_cast<void>(motion_blur(frame.file(), {.exposure = {0, 1}, .fit_px = px})), Error);
    for (const int views : {0, -4, 100000})
        EXPECT_THROW(static_cast<void>(motion_blur(frame.file(), {.exposure = {0, 1}, .views = views})),
                     Error);
}

}  // namespace
}  // namespace postlens::test::motion_blur_test
