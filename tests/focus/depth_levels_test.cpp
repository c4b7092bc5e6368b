// The depth levels that circles of confusion are rounded to.
#include "focus/responses/depth_levels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <limits>
#include <optional>
#include <string>

#include "core/error.h"
#include "tests/focus/focus_records.h"
#include "tests/support/refusal.h"

namespace postlens::test::depth_levels_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double diameter_error(const DepthLevels& levels, double inverse_depth) {
    const auto level = levels.level_of(inverse_depth);
    if (!level) return infinity;
    return std::abs(2 * levels.radius_px()[*level] - std::abs(lens_geometry.coc_diameter_px(inverse_depth)));
}

TEST(DepthLevels, OwnChoiceQuantisesTheCocByLessThanAQuarterOfAPixel) {
    const DepthLevels levels(lens_geometry, {0.3, 100.0}, DepthSpacing::inverse, std::nullopt);
    for (double inverse = 0; inverse < 30; inverse += 1e-3) {
        const bool sharp = std::abs(lens_geometry.coc_diameter_px(inverse)) < 0.4;
        EXPECT_LT(diameter_error(levels, inverse), sharp ? 0.4 : 0.25) << inverse;
    }
    // Inverse depths can be negative after reflection or refraction.
    for (double inverse = -20; inverse < 0; inverse += 1e-3)
        EXPECT_LT(diameter_error(levels, inverse), 0.25) << inverse;
    // Small CoCs have an error of at most 1 % or 1/16 px.
    for (double inverse = 0; inverse < 1.2; inverse += 1e-4) {
        const double diameter_px = std::abs(lens_geometry.coc_diameter_px(inverse));
        if (diameter_px < 0.4) {
            EXPECT_EQ(levels.level_of(inverse), 0U) << inverse;
        } else if (diameter_px < 24.5) {
            EXPECT_LE(diameter_error(levels, inverse), std::max(0.0626, 0.0101 * diameter_px)) << inverse;
        }
    }
    // Very large CoCs have an error of at most 1/500.
    for (double inverse = 50; inverse < 4000; inverse *= 1.01) {
        EXPECT_LT(diameter_error(levels, inverse), 2e-3 * lens_geometry.coc_diameter_px(-inverse)) << inverse;
    }
    EXPECT_EQ(levels.radius_px()[*levels.level_of(1e30)], DepthLevels::largest_radius_px);
    EXPECT_EQ(levels.radius_px()[*levels.level_of(0.2)], DepthLevels::smallest_radius_px);
    EXPECT_FALSE(levels.depths().has_value());
}

TEST(DepthLevels, GivenNumberIsLaidFromNearestToFarthest) {
    const DepthRange range{0.5, 8.5};
    const DepthLevels linear(lens_geometry, range, DepthSpacing::linear, 5);
    const DepthLevels inverse(lens_geometry, range, DepthSpacing::inverse, 5);
    ASSERT_EQ(linear.radius_px().size(), 6U);
    for (int i = 0; i < 5; ++i) {
        const auto level = static_cast<std::size_t>(i);
        EXPECT_NEAR(linear.radius_px()[level],
                    std::abs(lens_geometry.coc_diameter_px(1 / (0.5 + 2.0 * i))) / 2, 1e-9);
        EXPECT_NEAR(inverse.radius_px()[level],
                    std::abs(lens_geometry.coc_diameter_px(2 + (1 / 8.5 - 2) * i / 4)) / 2, 1e-9);
    }
    EXPECT_EQ(linear.level_of(1 / 3.4), 1U);
    EXPECT_EQ(linear.level_of(1 / 3.6), 2U);
    EXPECT_EQ(linear.level_of(0), 5U);
    EXPECT_EQ(inverse.level_of(0), 5U);
    EXPECT_EQ(inverse.level_of(2), 0U);
    EXPECT_EQ(inverse.level_of(1 / 8.5), 4U);
    EXPECT_NEAR(linear.radius_px()[5], lens_geometry.coc_diameter_px(0) / 2, 1e-12);
    EXPECT_FALSE(linear.level_of(-1).has_value());
    EXPECT_FALSE(inverse.level_of(9).has_value());
    EXPECT_EQ(linear.depths(), 5);
}

TEST(DepthLevels, LinearSpacingTakesAsManyAsItNeeds) {
    const DepthLevels levels(lens_geometry, {2.0, 6.0}, DepthSpacing::linear, std::nullopt);
    ASSERT_TRUE(levels.depths().has_value());
    EXPECT_LT(*levels.depths(), DepthLevels::most_linear_levels);
    for (double z_m = 2; z_m <= 6; z_m += 1e-3) EXPECT_LT(diameter_error(levels, 1 / z_m), 0.5) << z_m;
    const DepthLevels capped(lens_geometry, {0.1, 1000.0}, DepthSpacing::linear, std::nullopt);
    EXPECT_EQ(*capped.depths(), DepthLevels::most_linear_levels);
}

TEST(DepthLevels, OneDepthOrNoneIsEnough) {
    for (const DepthSpacing spacing : {DepthSpacing::linear, DepthSpacing::inverse}) {
        const DepthLevels one(lens_geometry, {3.0, 3.0}, spacing, 8);
        EXPECT_EQ(one.level_of(1 / 3.0), 0U);
        EXPECT_NEAR(one.radius_px()[0], std::abs(lens_geometry.coc_diameter_px(1 / 3.0)) / 2, 1e-12);
        EXPECT_FALSE(one.level_of(1).has_value());
        const DepthLevels none(lens_geometry, {}, spacing, 8);
        EXPECT_EQ(none.level_of(0), 0U);
        EXPECT_FALSE(none.level_of(1).has_value());
    }
}

TEST(DepthLevels, RefusesNumbersOutOfRange) {
    for (const int k : {-1, 0, 1, DepthLevels::most_depths + 1}) {
        expect_refused(
            [&] {
                const DepthLevels levels(lens_geometry, {1.0, 2.0}, DepthSpacing::inverse, k);
            },
            ExitCode::wrong_arguments, "number of depths is out of range (got " + std::to_string(k));
    }
}

}  // namespace
}  // namespace postlens::test::depth_levels_test
