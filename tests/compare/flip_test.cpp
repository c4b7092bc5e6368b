// FLIP against the values of an independent implementation, and at its limits.
#include "compare/metrics/flip.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>

#include "compare/metrics/fast_math.h"
#include "compare/metrics/flip_tile.h"
#include "core/threads.h"
#include "tests/support/compare_pictures.h"

namespace postlens::test::flip_test {
namespace {

Image data(const char* name) {
    return read_image(std::filesystem::path(POSTLENS_TEST_DATA) / "flip" / name);
}

struct Extremes {
    double mean;
    float max;
    int x, y;
};

Extremes extremes(const std::vector<float>& map, int width) {
    const auto at = static_cast<int>(std::max_element(map.begin(), map.end()) - map.begin());
    double sum = 0;
    for (const float v : map) sum += static_cast<double>(v);
    return {sum / static_cast<double>(map.size()), map[static_cast<std::size_t>(at)], at % width, at / width};
}

// The expected maps are half floats with a relative error of 2^-11. The rest of the tolerance of 1e-3 is for
// float sums in another order.
void expect_map(const std::vector<float>& map, const char* name) {
    const Image expected = data(name);
    ASSERT_EQ(map.size(), expected.rgb.size() / 3);
    for (std::size_t i = 0; i < map.size(); ++i) EXPECT_NEAR(map[i], expected.rgb[3 * i], 1e-3) << i;
}

TEST(Flip, LdrIsAsExpected) {
    const Image reference = data("reference-crop.exr"), test = data("test-crop.exr");
    const auto map = flip_map(reference, test, every_pixel(test));
    const Extremes e = extremes(map, test.width);
    EXPECT_NEAR(e.mean, 0.309864, 1e-4);
    EXPECT_NEAR(e.max, 0.775379, 1e-4);
    EXPECT_EQ(e.x, 21);
    EXPECT_EQ(e.y, 146);
    expect_map(map, "reference-test-flip-ldr.exr");
}

TEST(Flip, HdrIsAsExpected) {
    const Image reference = data("reference-crop.exr"), test = data("test-crop.exr");
    const FlipExposures exposures = flip_exposures(reference, every_pixel(test));
    EXPECT_NEAR(exposures.start, -12.5415, 1e-4);
    EXPECT_NEAR(exposures.stop, 1.10816, 1e-3);
    EXPECT_EQ(exposures.count, 14);
    const auto map = hdr_flip_map(reference, test, every_pixel(test), exposures);
    const Extremes e = extremes(map, test.width);
    EXPECT_NEAR(e.mean, 0.278933, 1e-4);
    EXPECT_NEAR(e.max, 0.840209, 1e-3);
    EXPECT_EQ(e.x, 110);
    EXPECT_EQ(e.y, 137);
    expect_map(map, "reference-test-flip-auto.exr");
}

TEST(Flip, HdrWithAWhiteLevelIsAsExpected) {
    const Image reference = data("reference-crop.exr"), test = data("test-crop.exr");
    const FlipExposures exposures = flip_exposures(reference, every_pixel(test), 2.0);
    EXPECT_NEAR(exposures.start, 0.083297, 1e-5);
    EXPECT_NEAR(exposures.stop, 3.55723, 1e-5);
    EXPECT_EQ(exposures.count, 4);
    const auto map = hdr_flip_map(reference, test, every_pixel(test), exposures);
    const Extremes e = extremes(map, test.width);
    EXPECT_NEAR(e.mean, 0.24964, 1e-4);
    EXPECT_NEAR(e.max, 0.726651, 1e-3);
    EXPECT_EQ(e.x, 101);
    EXPECT_EQ(e.y, 92);
    expect_map(map, "reference-test-flip-oiio.exr");
}

TEST(Flip, OfTwoConstantsIsAsExpected) {
    // The half floats nearest to 0.1 and 0.9.
    const Image dark = constant_picture(64, 64, 0.099975586F), light = constant_picture(64, 64, 0.89990234F);
    const PixelMask all = every_pixel(dark);
    const FlipExposures exposures = flip_exposures(dark, all);
    EXPECT_NEAR(exposures.start, 4.41, 0.005);
    EXPECT_EQ(exposures.count, 2);
    for (const float v : flip_map(dark, light, all)) EXPECT_NEAR(v, 0.9514, 1e-4);
    for (const float v : hdr_flip_map(dark, light, all, exposures)) EXPECT_NEAR(v, 0.2045, 1e-4);
}

TEST(Flip, IsZeroForEqualPicturesAndSymmetric) {
    const Image a = data("reference-crop.exr"), b = data("test-crop.exr");
    const PixelMask all = every_pixel(a);
    for (const float v : flip_map(a, a, all)) EXPECT_EQ(v, 0);
    for (const float v : hdr_flip_map(b, b, all, flip_exposures(b, all))) EXPECT_EQ(v, 0);
    EXPECT_EQ(flip_map(a, b, all), flip_map(b, a, all));
}

TEST(Flip, BlackPicturesComeToAnEnd) {
    const Image black(300, 200), light = constant_picture(300, 200, 0.8F);
    const PixelMask all = every_pixel(black);
    const FlipExposures dark = flip_exposures(black, all);
    EXPECT_EQ(dark.start, 0);
    EXPECT_EQ(dark.stop, 0);
    EXPECT_EQ(dark.count, 1);
    for (const float v : hdr_flip_map(black, black, all, dark)) EXPECT_EQ(v, 0);
    for (const float v : hdr_flip_map(black, light, all, dark)) EXPECT_GT(v, 0.5F);
    for (const float v : flip_map(black, light, all)) EXPECT_GT(v, 0.5F);
    // If the median is 0, the median of the pixels that are not black is used.
    Image spot = black;
    for (int c = 0; c < 3; ++c) spot.pixel(7, 9)[c] = 2;
    const FlipExposures of_spot = flip_exposures(spot, all);
    EXPECT_TRUE(std::isfinite(of_spot.stop));
    EXPECT_EQ(of_spot.count, 2);
    const auto map = hdr_flip_map(spot, black, all, of_spot);
    EXPECT_EQ(extremes(map, 300).x, 7);
    EXPECT_EQ(extremes(map, 300).y, 9);
}

TEST(Flip, ExtremeValuesKeepExposuresFewAndErrorsFinite) {
    Image reference = constant_picture(64, 64, 1e-38F);
    reference.pixel(10, 10)[1] = 3e38F;
    reference.pixel(20, 20)[1] = -3e38F;
    const PixelMask all = every_pixel(reference);
    const FlipExposures exposures = flip_exposures(reference, all);
    EXPECT_LE(exposures.count, 30);
    for (const float v : hdr_flip_map(reference, constant_picture(64, 64, 0.5F), all, exposures)) {
        EXPECT_GE(v, 0);
        EXPECT_LE(v, 1);
    }
    for (const float v : flip_map(reference, constant_picture(64, 64, 0.5F), all))
        EXPECT_TRUE(v >= 0 && v <= 1);
    for (const float v :
         hdr_flip_map(constant_picture(9, 5, 1e-45F), constant_picture(9, 5, 1), PixelMask(45, 1),
                      flip_exposures(constant_picture(9, 5, 1e-45F), PixelMask(45, 1))))
        EXPECT_TRUE(v >= 0 && v <= 1);
}

TEST(Flip, APixelThatIsNotUsableIsBlackInBoth) {
    const Image a = constant_picture(64, 64, 0.5F);
    Image b = a;
    b.pixel(30, 30)[0] = std::numeric_limits<float>::quiet_NaN();
    PixelMask usable = every_pixel(a);
    usable[30 * 64 + 30] = 0;
    for (const float v : flip_map(a, b, usable)) EXPECT_EQ(v, 0);
}

TEST(Flip, FiltersAreNormalised) {
    const FlipFilters f(flip_pixels_per_degree);
    EXPECT_EQ(f.radius, 10);
    const auto sum = [](const TileChannel& taps, bool positive) {
        double total = 0;
        for (const float t : taps) total += (t > 0) == positive ? static_cast<double>(t) : 0;
        return total;
    };
    // A filter has 21 floats of at most 0.3, each with a relative rounding error of up to 6e-8.
    EXPECT_NEAR(sum(f.achromatic, true), 1, 1e-6);
    EXPECT_NEAR(sum(f.red_green, true), 1, 1e-6);
    EXPECT_NEAR(sum(f.blue_yellow_1_column, true) + sum(f.blue_yellow_2_column, true), 1, 1e-6);
    EXPECT_NEAR(sum(f.gauss, true), 1, 1e-6);
    for (const TileChannel* detector : {&f.edge, &f.point}) {
        EXPECT_NEAR(sum(*detector, true), 1, 1e-6);
        EXPECT_NEAR(sum(*detector, false), -1, 1e-6);
    }
}

TEST(FastMath, PowersAndCubeRoots) {
    for (double v = 1e-12; v < 300; v *= 1.07) {
        const auto x = static_cast<float>(v);
        EXPECT_NEAR(cube_root(x) / std::cbrt(static_cast<double>(x)), 1, 3e-7) << v;
        for (const float exponent : {0.0F, 0.01F, 0.3F, 0.7F, 1.0F})
            EXPECT_NEAR(power(x, exponent) / std::pow(static_cast<double>(x), static_cast<double>(exponent)),
                        1, 4e-6)
                << v;
    }
    EXPECT_EQ(power(0, 0.7F), 0);
}

TEST(Flip, SameBitsForAnyNumberOfThreads) {
    const Image a = data("reference-crop.exr"), b = data("test-crop.exr");
    const PixelMask all = every_pixel(a);
    const FlipExposures exposures = flip_exposures(a, all);
    const auto map = [&](int threads) {
        const ThreadLimit limit(threads);
        return hdr_flip_map(a, b, all, exposures);
    };
    const auto one = map(1);
    EXPECT_EQ(map(2), one);
    EXPECT_EQ(map(5), one);
}

}  // namespace
}  // namespace postlens::test::flip_test
