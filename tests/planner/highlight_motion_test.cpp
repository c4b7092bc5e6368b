// Light of a highlight that moves while the shutter is open.
#include <cstdint>
#include <gtest/gtest.h>
#include <set>
#include <vector>

#include "focus/light_field/moving_highlights.h"
#include "reproject/patches/patches.h"
#include "reproject/raster_map.h"

namespace postlens::test::highlight_motion_test {
namespace {

TEST(HighlightMotion, MomentsShareTheLightAlongTheWay) {
    const PatchLens lens{.radius_px_m = 20, .inverse_focus_per_m = 0.5};
    const auto along = [](std::uint32_t /*id*/, double u) {
        glm::dmat4 m(1);
        m[2][0] = 12 * u;  // moves by 12 px to the right
        return RasterMap(m, Projection::perspective);
    };
    const HighlightMotion motion([](std::uint32_t id) { return id == 7; }, along, lens);
    Highlight light;
    light.x = 20;
    light.y = 10;
    light.rgb = {3, 2, 1};
    light.area = 0.5F;
    light.inverse_z = 0.5F;  // in focus
    light.w = Mat2::isotropic(0.5F);
    const SheetKey mine{NodePath(), 0, 7};
    EXPECT_EQ(motion.moments_wanted(light, mine), 32);  // steps of half a pixel would be 24
    const std::vector<HighlightMotion::Moment> got = motion.moments(light, mine, 32);
    ASSERT_EQ(got.size(), 32);
    double share = 0, x = 0;
    for (const HighlightMotion::Moment& m : got) {
        share += m.share;
        x += m.share * static_cast<double>(m.light.x);
        EXPECT_NEAR(static_cast<double>(m.light.x), 20 + 12 * m.u, 1e-5);
        EXPECT_EQ(m.light.y, 10);
        EXPECT_NEAR(m.light.rgb[0], 3, 1e-5F);
        EXPECT_EQ(m.light.inverse_z, 0.5F);
    }
    EXPECT_NEAR(share, 1, 1e-12);
    EXPECT_NEAR(x, 26, 1e-5);
    // With fewer moments than wanted, neighbouring lights use different moments.
    std::set<double> places;
    for (int i = 0; i < 16; ++i) {
        light.y = 10 + 0.25F * static_cast<float>(i);
        const auto few = motion.moments(light, mine, 4, true);
        ASSERT_EQ(few.size(), 4);
        for (const HighlightMotion::Moment& m : few) places.insert(m.u);
        EXPECT_NEAR(few[3].u - few[0].u, 0.75, 1e-12);
    }
    EXPECT_GT(places.size(), 4U * 8);
    light.y = 10;
    // Other objects, and mirror images of this one, do not move.
    for (const SheetKey& key :
         {SheetKey{NodePath(), 0, 8}, SheetKey{NodePath().child(NodePath::Bounce::reflected), 7, 7}}) {
        EXPECT_EQ(motion.moments_wanted(light, key), 1);
        const auto still = motion.moments(light, key, 32);
        ASSERT_EQ(still.size(), 1);
        EXPECT_EQ(still[0].u, -1);
        EXPECT_EQ(still[0].light.x, 20);
    }
    EXPECT_TRUE(HighlightMotion::takes(light, 1));  // 6 on the mean
    EXPECT_FALSE(HighlightMotion::takes(light, HighlightMotion::largest_px2));
    light.area = 2;
    EXPECT_FALSE(HighlightMotion::takes(light, 2));
}

// At half the distance a light is twice as large, has four times the area, and another CoC.
TEST(HighlightMotion, WhatComesNearerGrowsAndWhatPassesTheCameraIsGone) {
    const PatchLens lens{.radius_px_m = 20, .inverse_focus_per_m = 0.5};
    const auto nearer = [](std::uint32_t /*id*/, double u) {
        // About (0, 0): from 2 m to 0 m at u = 1.
        glm::dmat4 m(1);
        m[3][2] = -2 * u;
        return RasterMap(m, Projection::perspective);
    };
    const HighlightMotion motion([](std::uint32_t) { return true; }, nearer, lens);
    Highlight light;
    light.x = light.y = 4;
    light.rgb = {1, 1, 1};
    light.area = 1;
    light.inverse_z = 0.5F;
    light.w = Mat2::isotropic(0.5F);
    EXPECT_EQ(motion.moments_wanted(light, {NodePath(), 0, 1}), HighlightMotion::most_moments);
    const auto got = motion.moments(light, {NodePath(), 0, 1}, 1 << 16);
    ASSERT_GT(got.size(), 60000);
    EXPECT_LT(got.size(), 1U << 16U) << "the last are too near";
    for (const HighlightMotion::Moment& m : got) {
        const double depth_m = 2 - 2 * m.u, larger = 2 / depth_m;
        EXPECT_NEAR(static_cast<double>(m.light.x), 4 * larger, 1e-3 * larger);
        EXPECT_NEAR(static_cast<double>(m.light.inverse_z) * depth_m, 1, 1e-4);
        EXPECT_NEAR(static_cast<double>(m.light.rgb[1]) / (larger * larger), 1, 1e-3);
        EXPECT_EQ(m.light.w, Mat2::isotropic(m.light.inverse_z));
    }
}

}  // namespace
}  // namespace postlens::test::highlight_motion_test
