// Motion blur against closed forms, limiting cases and invariants.
#include "motionblur/motion_blur.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/threads.h"
#include "tests/support/motion_frame.h"
#include "tracer/render.h"

namespace postlens::test::motion_blur_test {
namespace {

using glm::dvec3;

constexpr double depth_m = 4;
constexpr double m_per_px = depth_m / px_per_m;

// A bar of radiance 1 on black, with its left edge at column `left`, `width` px wide and over the whole
// height. It moves by `way` px to the right.
Scene bar(double left, double width, double way, std::vector<TransformKey> keys = {}) {
    SceneBuilder b;
    Object& o =
        b.add(Rectangle{{(left - 32) * m_per_px, -10, -depth_m}, {width * m_per_px, 0, 0}, {0, 20, 0}},
              glowing(dvec3(1)));
    o.keys = keys.empty() ? from_to({way * m_per_px, 0, 0}) : std::move(keys);
    return b.scene;
}

// The fraction of the exposure during which the bar covers x, for a box shutter and constant speed.
double trapezoid(double x, double left, double width, double way) {
    const auto integral = [&](double edge) {  // fraction of the time in which the edge is left of x
        return way == 0 ? (x >= edge ? 1.0 : 0.0) : std::clamp((x - edge) / way, 0.0, 1.0);
    };
    return integral(left) - integral(left + width);
}

double pixel_mean(int x, double left, double width, double way) {
    double sum = 0;
    constexpr int steps = 1000;
    for (int i = 0; i < steps; ++i) sum += trapezoid(x + (i + 0.5) / steps, left, width, way);
    return sum / steps;
}

bool equal_bits(const Image& a, const Image& b) {
    return a.rgb.size() == b.rgb.size() &&
           std::memcmp(a.rgb.data(), b.rgb.data(), a.rgb.size() * sizeof(float)) == 0;
}

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

// A plate over a chequered wall: what it uncovers is recorded with the shutter named, else filled.
Scene plate_over_wall() {
    SceneBuilder b;
    for (int i = -6; i < 6; ++i) {
        const double shade = i % 2 == 0 ? 0.8 : 0.1;
        b.add(Rectangle{{i * 0.4, -2, -6}, {0.4, 0, 0}, {0, 4, 0}}, glowing(dvec3(shade)));
    }
    b.add(Rectangle{{-0.6, -0.5, -4}, {0.8, 0, 0}, {0, 1, 0}}, glowing({0.2, 0.9, 0.3})).keys =
        from_to({20 * m_per_px, 0, 0});
    return b.scene;
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

TEST(MotionBlur, AutomaticConvolvesTranslationsAndReprojectsTheRest) {
    SceneBuilder b;
    b.add(Rectangle{{-1.2, 0.2, -4}, {0.6, 0, 0}, {0, 0.6, 0}}, glowing(dvec3(0.9))).keys =
        from_to({0.3, 0, 0});
    Object& turning = b.add(Rectangle{{-0.3, -0.3, 0}, {0.6, 0, 0}, {0, 0.6, 0}}, glowing(dvec3(0.6)));
    turning.motion_base = glm::dmat4(1);
    turning.keys = {
        {.time_s = 0, .translation = {0.9, -0.4, -4}},
        {.time_s = 1, .translation = {0.9, -0.4, -4}, .rotation = glm::angleAxis(0.8, dvec3(0, 0, 1))}};
    b.add(Rectangle{{-3, -3, -8}, {6, 0, 0}, {0, 6, 0}}, glowing(dvec3(0.3)));
    const TracedFrame frame(b.scene, for_shutter());
    const MotionBlurResult r = frame.blur(MotionMethod::automatic);
    ASSERT_EQ(r.objects.size(), 2U);
    EXPECT_EQ(r.objects[0].method, MotionMethod::convolve);
    EXPECT_EQ(r.objects[0].kind, MotionKind::translation);
    EXPECT_EQ(r.objects[1].method, MotionMethod::lightfield);
    EXPECT_EQ(r.method, MotionMethod::automatic);
    const Image convolved = frame.blur(MotionMethod::convolve).image,
                reprojected = frame.blur(MotionMethod::lightfield).image;
    for (int y = 0; y < 48; ++y) {  // the left part equals `convolve`, the right part `lightfield`
        for (int x = 0; x < 24; ++x) EXPECT_EQ(r.image.pixel(x, y)[0], convolved.pixel(x, y)[0]);
        for (int x = 44; x < 64; ++x) EXPECT_EQ(r.image.pixel(x, y)[0], reprojected.pixel(x, y)[0]);
    }
}

TEST(MotionBlur, AutomaticReprojectsWhatTheBorderCutsAtTheFramesInstant) {
    // The bar comes in from columns [-20, 4). The second key shows it whole, in columns [20, 44).
    TraceSettings settings = for_shutter();
    settings.overscan_px = 0;
    settings.keys = 2;
    const Scene scene = bar(-20, 24, 40);
    const TracedFrame frame(scene, settings);
    ASSERT_EQ(frame.file().instants(), 2U);
    const MotionBlurResult r = frame.blur(MotionMethod::automatic);
    ASSERT_EQ(r.objects.size(), 1U);
    EXPECT_EQ(r.objects[0].kind, MotionKind::translation);
    EXPECT_EQ(r.objects[0].method, MotionMethod::lightfield);
    EXPECT_NE(r.objects[0].reason.find("the border cuts it"), std::string::npos) << r.objects[0].reason;
    EXPECT_FALSE(has_warning(r, "overscan"));
    for (int x = 0; x < 64; ++x)
        EXPECT_NEAR(static_cast<double>(r.image.pixel(x, 20)[0]), pixel_mean(x, -20, 24, 40), 0.03) << x;
    EXPECT_TRUE(has_warning(frame.blur(MotionMethod::convolve), "overscan"));
    // A wider bar comes in from where the frame's instant shows none of it. At the second key, in columns
    // [-10, 70), the right border cuts it, and this side is in the frame before.
    const MotionBlurResult wider = TracedFrame(bar(-100, 80, 90), settings).blur(MotionMethod::automatic);
    const auto cut = std::ranges::find(wider.warnings, "overscan", &MotionWarning::code);
    ASSERT_NE(cut, wider.warnings.end());
    // The file has several keys already, so the warning names what else helps.
    EXPECT_NE(cut->text.find("more --keys or overscan"), std::string::npos) << cut->text;
    // With one instant alone, lightfield lacks the same part, but finds the pixels that it may cover.
    settings.keys = 1;
    const MotionBlurResult one = TracedFrame(scene, settings).blur(MotionMethod::automatic);
    ASSERT_EQ(one.objects.size(), 1U);
    EXPECT_EQ(one.objects[0].method, MotionMethod::lightfield);
    EXPECT_TRUE(has_warning(one, "overscan"));
    EXPECT_TRUE(has_warning(one, "uncovered"));
}

TEST(MotionBlur, TheBackgroundBehindACutSurfaceIsNoPartOfThePicture) {
    // The camera moves sideways past a uniform wall, which the border of the records cuts. Behind the wall,
    // the black background is recorded.
    SceneBuilder b;
    b.add(Rectangle{{-50, -50, -4}, {100, 0, 0}, {0, 100, 0}}, glowing(dvec3(0.6)));
    b.scene.cameras[0].keys = from_to({30 * m_per_px, 0, 0});
    TraceSettings settings = for_shutter();
    settings.overscan_px = 0;
    const TracedFrame cut(b.scene, settings);
    ASSERT_TRUE(cut.file().header().has_layers);
    const MotionBlurResult r = cut.blur(MotionMethod::automatic);
    EXPECT_TRUE(has_warning(r, "uncovered"));
    EXPECT_TRUE(has_warning(cut.blur(MotionMethod::convolve), "overscan"));
    for (int x = 0; x < 64; ++x) EXPECT_NEAR(static_cast<double>(r.image.pixel(x, 20)[0]), 0.6, 1e-6) << x;
    settings.overscan_px = 32;
    EXPECT_FALSE(has_warning(TracedFrame(b.scene, settings).blur(MotionMethod::automatic), "uncovered"));
}

// Plates of 15 px at two depths. `apart_px`: distance of their rows.
Scene two_plates(double apart_px, double near_way_px, double far_way_px) {
    SceneBuilder b;
    const auto add = [&](double depth, double top_px, double way_px, double radiance) {
        const double px = depth / px_per_m;
        b.add(Rectangle{{-(7.5 + way_px / 2) * px, top_px * px, -depth}, {15 * px, 0, 0}, {0, 15 * px, 0}},
              glowing(dvec3(radiance)))
            .keys = from_to({way_px * px, 0, 0});
    };
    add(3, apart_px / 2 - 7.5, near_way_px, 0.02);
    add(4, -apart_px / 2 - 7.5, far_way_px, 0.9);
    b.add(Rectangle{{-9, -9, -8}, {18, 0, 0}, {0, 18, 0}}, glowing(dvec3(0.2)));
    return b.scene;
}

TEST(MotionBlur, AutomaticReprojectsWhatCrosses) {
    // Both plates stand in the middle at the same instants, where the far one must never show.
    const Scene scene = two_plates(0, 24, -24);
    RenderSettings truth;
    truth.spp = 1024;
    truth.shutter = TimeSpan{0, 1};
    const Image reference = render_picture(scene, truth).image;
    const TracedFrame frame(scene, for_shutter(4));
    const MotionBlurResult r = frame.blur(MotionMethod::automatic);
    ASSERT_EQ(r.objects.size(), 2U);
    for (const ObjectReport& o : r.objects) {
        EXPECT_EQ(o.kind, MotionKind::translation);
        EXPECT_EQ(o.method, MotionMethod::lightfield) << o.reason;
        EXPECT_NE(o.reason.find("moves over the same pixels"), std::string::npos) << o.reason;
        EXPECT_EQ(o.slices, 0);
    }
    EXPECT_GT(psnr(r.image, reference), 42);
    EXPECT_LT(psnr(frame.blur(MotionMethod::convolve).image, reference), 36);
    // A plate covers a texture that moves behind it at some instants only.
    SceneBuilder striped;
    striped.add(Rectangle{{-0.6, -0.5, -4}, {0.8, 0, 0}, {0, 1, 0}}, glowing(dvec3(0.5))).keys =
        from_to({20 * m_per_px, 0, 0});
    for (int i = -20; i < 20; ++i) {
        striped
            .add(Rectangle{{i * 0.4, -9, -8}, {0.4, 0, 0}, {0, 18, 0}},
                 glowing(dvec3(i % 2 == 0 ? 0.9 : 0.1)))
            .keys = from_to({1, 0, 0});
    }
    EXPECT_EQ(TracedFrame(striped.scene, for_shutter()).blur(MotionMethod::automatic).method,
              MotionMethod::lightfield);
    // Plates beside each other, and plates that stand still on the raster or move alike, do not cross.
    for (const Scene& other : {two_plates(16, 24, -24), two_plates(0, 24, 0), two_plates(0, 24, 24)}) {
        const MotionBlurResult alone = TracedFrame(other, for_shutter()).blur(MotionMethod::automatic);
        EXPECT_EQ(alone.method, MotionMethod::convolve);
    }
}

TEST(MotionBlur, KeysDoNotTakeAConvolvedObjectFromConvolve) {
    TraceSettings settings = for_shutter();
    settings.keys = 2;
    const TracedFrame frame(plate_over_wall(), settings);
    ASSERT_EQ(frame.file().instants(), 2U);
    const MotionBlurResult chosen = frame.blur(MotionMethod::automatic),
                           convolved = frame.blur(MotionMethod::convolve);
    ASSERT_EQ(chosen.objects.size(), 1U);
    EXPECT_EQ(chosen.objects[0].method, MotionMethod::convolve);
    EXPECT_EQ(chosen.method, MotionMethod::convolve);
    // The second key, at which the plate is elsewhere, does not change the wall here. Pixels at which four
    // tiles of the wall meet are left out: other hidden surfaces nearby make the keys' subdivisions differ.
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            if ((x == 31 || x == 32) && (y % 12 == 11)) continue;
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(chosen.image.pixel(x, y)[c], convolved.image.pixel(x, y)[c], 1e-6)
                    << x << ", " << y;
        }
    }
}

TEST(MotionBlur, AutomaticShowsTheSidesThatOnlyOtherKeysRecord) {
    // The box passes above the camera's axis, where its lower side is seen. At the frame's instant it is not.
    SceneBuilder b;
    b.add(Box{{-0.4, -0.4, -0.4}, {0.4, 0.4, 0.4}}, glowing({0.9, 0.5, 0.1})).keys = {
        {.time_s = 0, .translation = {-0.3, 0, -4}}, {.time_s = 1, .translation = {0.3, 1.2, -4}}};
    b.add(Rectangle{{-5, -4, -8}, {10, 0, 0}, {0, 8, 0}}, glowing({0.1, 0.2, 0.6}));
    TraceSettings settings = for_shutter(4);
    settings.keys = 5;
    const TracedFrame frame(b.scene, settings);
    RenderSettings truth;
    truth.spp = 256;
    truth.shutter = TimeSpan{0, 1};
    const Image reference = render_picture(b.scene, truth).image;
    const MotionBlurResult r = frame.blur(MotionMethod::automatic);
    ASSERT_EQ(r.objects.size(), 1U);
    EXPECT_EQ(r.objects[0].kind, MotionKind::parallax);
    EXPECT_EQ(r.objects[0].method, MotionMethod::lightfield) << r.objects[0].reason;
    EXPECT_GT(psnr(r.image, reference), 42);
    EXPECT_LT(psnr(frame.blur(MotionMethod::convolve).image, reference), 38);
}

TEST(MotionBlur, WhatGrowsOrVanishesHasTheOutlineOfTheKeyThatShowsItLarge) {
    // At one of the two keys, a single ray hits the ball. Magnified to its size at other instants, the leaf
    // of this ray covers much of the picture.
    constexpr dvec3 at(0, 0, -4);
    const std::vector<std::vector<TransformKey>> motions{
        {{.time_s = 0, .translation = at, .scale = dvec3(1e-3)}, {.time_s = 1, .translation = at}},
        {{.time_s = 0.5, .translation = at}, {.time_s = 0.500001, .translation = at, .scale = dvec3(1e-6)}}};
    for (const std::vector<TransformKey>& keys : motions) {
        SceneBuilder b;
        b.add(Sphere{dvec3(0), 0.4}, glowing({0.9, 0.5, 0.1})).keys = keys;
        b.add(Rectangle{{-5, -4, -8}, {10, 0, 0}, {0, 8, 0}}, glowing({0.1, 0.2, 0.6}));
        TraceSettings settings = for_shutter(4);
        settings.keys = 2;
        RenderSettings truth;
        truth.spp = 256;
        truth.shutter = TimeSpan{0, 1};
        EXPECT_GT(psnr(TracedFrame(b.scene, settings).blur(MotionMethod::automatic).image,
                       render_picture(b.scene, truth).image),
                  42);
    }
}

// A plate that moves parallel to the film close to a wall. Light falls on both.
SceneBuilder lit_plate() {
    SceneBuilder b;
    b.add(Rectangle{{-5, -4, -6}, {10, 0, 0}, {0, 8, 0}}, matte(dvec3(0.8)));
    b.add(Rectangle{{-0.8, -0.5, -5}, {0.8, 0, 0}, {0, 1, 0}}, matte(dvec3(0.7))).keys =
        from_to({20 * m_per_px, 0, 0});
    b.point_light({0.3, 1.5, -3.5});
    return b;
}

TEST(MotionBlur, KeysShowTheShadingAndShadowOfWhatMovesAsAWhole) {
    SceneBuilder passing = lit_plate(), light_moves = lit_plate();
    passing.scene.lights[0].casts_shadows = false;
    passing.scene.lights[0].position = {0.2, 0.1, -4.5};
    light_moves.scene.lights[0].keys = from_to({-1, 0, 0});
    TraceSettings settings = for_shutter(3);
    settings.keys = 9;
    for (const Scene& scene : {lit_plate().scene, passing.scene, light_moves.scene}) {
        RenderSettings truth;
        truth.spp = 256;
        truth.shutter = TimeSpan{0, 1};
        const Image reference = render_picture(scene, truth).image;
        const TracedFrame frame(scene, settings);
        const MotionBlurResult r = frame.blur(MotionMethod::automatic);
        ASSERT_EQ(r.objects.size(), 1U);
        EXPECT_EQ(r.objects[0].kind, MotionKind::translation);
        EXPECT_EQ(r.objects[0].method, MotionMethod::lightfield) << r.objects[0].reason;
        EXPECT_GT(psnr(r.image, reference), 38);
        EXPECT_LT(psnr(frame.blur(MotionMethod::convolve).image, reference), 32);
    }
}

TEST(MotionBlur, KeysShowOneInstantInItsOwnLight) {
    SceneBuilder b;
    b.add(Rectangle{{-5, -4, -6}, {10, 0, 0}, {0, 8, 0}}, matte(dvec3(0.8)));
    b.point_light({-1, 0, -4}).keys = from_to({2, 0, 0});
    TraceSettings settings = for_shutter();
    settings.keys = 3;
    const TracedFrame frame(b.scene, settings);
    TraceSettings at_half = settings;
    at_half.keys = 1;
    at_half.time_s = 0.5;
    const Image wanted = TracedFrame(b.scene, at_half).file().picture();
    const MotionBlurResult half = frame.blur(MotionMethod::automatic, 0.5, 0.5);
    for (std::size_t i = 0; i < wanted.rgb.size(); ++i) EXPECT_NEAR(half.image.rgb[i], wanted.rgb[i], 1e-6);
    EXPECT_FALSE(has_warning(half, "light"));
    // The frame's own instant is recorded as it is, whatever moves at others.
    const TracedFrame plate(lit_plate().scene, settings);
    for (const MotionMethod method :
         {MotionMethod::automatic, MotionMethod::convolve, MotionMethod::lightfield})
        EXPECT_TRUE(equal_bits(plate.blur(method, 0, 0).image, plate.file().picture()));
}

TEST(MotionBlur, SameBitsForAnyNumberOfThreads) {
    const TracedFrame frame(plate_over_wall(), for_shutter());
    for (const MotionMethod method : {MotionMethod::convolve, MotionMethod::lightfield}) {
        Image first;
        for (const int threads : {1, 2, 5}) {
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
