// What files with several keys (recorded instants) show.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "motionblur/motion_blur.h"
#include "tests/motionblur/moving_scenes.h"
#include "tests/support/motion_frame.h"
#include "tracer/render.h"

namespace postlens::test::motion_keys_test {
namespace {

using glm::dvec3;

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

}  // namespace
}  // namespace postlens::test::motion_keys_test
