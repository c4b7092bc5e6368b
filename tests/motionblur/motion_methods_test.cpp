// Which method `auto` chooses for each moving object.
#include <algorithm>
#include <gtest/gtest.h>

#include "motionblur/motion_blur.h"
#include "tests/motionblur/moving_scenes.h"
#include "tests/support/motion_frame.h"
#include "tracer/render.h"

namespace postlens::test::motion_methods_test {
namespace {

using glm::dvec3;

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

}  // namespace
}  // namespace postlens::test::motion_methods_test
