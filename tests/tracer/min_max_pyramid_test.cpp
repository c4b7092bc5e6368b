// Hierarchical searches of a raster, compared with a test of all values.
#include "tracer/shading_trees/min_max_pyramid.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

namespace postlens::test::min_max_pyramid_test {
namespace {

struct Raster {
    int x_begin = 0, y_begin = 0, width = 0, height = 0;
    std::vector<float> values;
};

/// A raster like one of depths: planes with steps between them, single values and holes.
Raster raster_of(std::mt19937& random, int width, int height) {
    std::uniform_real_distribution<float> share(0, 1);
    Raster out{-7, 3, width, height, {}};
    const float gx = share(random) - 0.5F, gy = share(random) - 0.5F;
    const auto edge = static_cast<int>(share(random) * static_cast<float>(width));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            float v =
                0.1F * (gx * static_cast<float>(x) + gy * static_cast<float>(y)) + (x < edge ? 2.0F : 0.0F);
            if (share(random) < 0.01F) v += 4 * share(random) - 2;
            out.values.push_back(share(random) < 0.05F ? std::numeric_limits<float>::quiet_NaN() : v);
        }
    }
    return out;
}

template <typename Look>
void for_each_value(const Raster& r, const glm::dvec2& at, const Look& look) {
    for (int y = 0; y < r.height; ++y) {
        for (int x = 0; x < r.width; ++x) {
            const float v = r.values[static_cast<std::size_t>(y * r.width + x)];
            if (!std::isnan(v))
                look(static_cast<double>(v), glm::length(glm::dvec2(x + r.x_begin, y + r.y_begin) - at));
        }
    }
}

/// Whether the cone contains a value within `reach`, tested for all values.
bool any_by_hand(const Raster& r, const MinMaxPyramid::Cone& cone, double reach) {
    bool found = false;
    for_each_value(r, cone.at, [&](double v, double d) {
        const double nearer = std::max(0.0, d - (reach - cone.radius));
        found = found || (d <= reach && cone.top - v >= std::max(cone.least, cone.slope * nearer));
    });
    return found;
}

TEST(MinMaxPyramid, FindsWhatLookingAtEveryValueFinds) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> share(0, 1);
    int yes = 0;
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {40, 33}, {64, 64}, {100, 5}}) {
        for (int n = 0; n < 400; ++n) {
            const Raster r = raster_of(random, width, height);
            const MinMaxPyramid pyramid(r.x_begin, r.y_begin, width, height, r.values);
            // Positions may be outside of the raster; radii range from less than a pixel to far beyond the
            // raster.
            MinMaxPyramid::Cone cone;
            cone.at = {r.x_begin + (1.4 * share(random) - 0.2) * width,
                       r.y_begin + (1.4 * share(random) - 0.2) * height};
            cone.radius = std::pow(10.0, 3 * share(random) - 0.5);
            cone.top = 4 * share(random) - 1;
            cone.least = 0.3 * share(random);
            cone.slope = 0.1 * share(random);
            const bool expected = any_by_hand(r, cone, cone.radius);
            yes += expected ? 1 : 0;
            ASSERT_EQ(pyramid.any_in(cone), expected) << width << "x" << height << ", " << n;
            if (expected) {
                ASSERT_TRUE(pyramid.maybe_any_in(cone));
            } else if (pyramid.maybe_any_in(cone)) {
                ASSERT_TRUE(any_by_hand(r, cone, 1.125 * cone.radius)) << n;
            }
            double within = cone.top, nearly = cone.top;
            for_each_value(r, cone.at, [&](double v, double d) {
                if (d <= cone.radius) within = std::max(within, v);
                if (d <= 1.125 * cone.radius) nearly = std::max(nearly, v);
            });
            const double greatest = pyramid.greatest(cone.at, cone.radius, cone.top);
            ASSERT_GE(greatest, within) << n;
            ASSERT_LE(greatest, nearly) << n;
            ASSERT_GE(pyramid.at_most(cone.at, cone.radius, cone.top), greatest) << n;
        }
    }
    EXPECT_GT(yes, 300);
    EXPECT_LT(yes, 1700);
}

// Any hint is valid, also one from another raster or from the coarser search.
TEST(MinMaxPyramid, HintsChangeNoAnswer) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> share(0, 1);
    MinMaxPyramid::Hint hint;
    int used = 0, enough = 0;
    for (const auto& [width, height] : {std::pair{64, 64}, {1, 9}, {40, 33}, {100, 5}}) {
        const Raster r = raster_of(random, width, height);
        const MinMaxPyramid pyramid(r.x_begin, r.y_begin, width, height, r.values);
        MinMaxPyramid::Cone cone;
        for (int n = 0; n < 2000; ++n) {
            // Most cones are close to the previous one, as for neighbouring samples.
            if (n % 10 == 0) {
                cone.at = {r.x_begin + (1.4 * share(random) - 0.2) * width,
                           r.y_begin + (1.4 * share(random) - 0.2) * height};
                cone.radius = std::pow(10.0, 2 * share(random) - 0.5);
                cone.top = 4 * share(random) - 1;
                cone.least = 0.3 * share(random);
                cone.slope = 0.1 * share(random);
            }
            cone.at += glm::dvec2(share(random) - 0.5, share(random) - 0.5);
            const MinMaxPyramid::Hint before = hint;
            const bool coarse = share(random) < 0.5;
            const bool shown = coarse ? pyramid.hint_maybe_in(cone, hint) : pyramid.hint_in(cone, hint);
            const bool got = coarse ? pyramid.maybe_any_in(cone, hint) : pyramid.any_in(cone, hint);
            ASSERT_EQ(got, coarse ? pyramid.maybe_any_in(cone) : pyramid.any_in(cone)) << n;
            ASSERT_TRUE(got || !shown) << n;
            enough += shown ? 1 : 0;
            used += got && before.level == hint.level && before.x == hint.x && before.y == hint.y ? 1 : 0;
        }
    }
    EXPECT_GT(used, 500);
    EXPECT_GT(enough, 500);
}

TEST(MinMaxPyramid, NothingIsInARasterOfHoles) {
    const MinMaxPyramid pyramid(0, 0, 8, 8, std::vector<float>(64, std::numeric_limits<float>::quiet_NaN()));
    EXPECT_FALSE(pyramid.any_in({{4, 4}, 100, 1e9, 0, 0}));
    EXPECT_FALSE(pyramid.maybe_any_in({{4, 4}, 100, 1e9, 0, 0}));
    EXPECT_EQ(pyramid.greatest({4, 4}, 100, -3), -3);
    EXPECT_EQ(pyramid.at_most({4, 4}, 100, -3), -3);
    EXPECT_EQ(pyramid.least(), std::numeric_limits<double>::infinity());
    EXPECT_FALSE(pyramid.any_in({{4, 4}, std::numeric_limits<double>::quiet_NaN(), 1e9, 0, 0}));
}

}  // namespace
}  // namespace postlens::test::min_max_pyramid_test
