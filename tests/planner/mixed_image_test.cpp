// The weights of another image that is mixed with the views, and the error that is stated for the mixed
// image, compared with simulated images whose error is known.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "pictures/crop.h"
#include "pictures/srgb.h"
#include "planner/stated_error.h"

namespace postlens::test::mixed_image_test {
namespace {

constexpr TileGrid large{256, 192}, small{64, 64};

/// Two halves of the views, and another image, of a gray scene. The errors are equal within a piece.
struct Simulated {
    FieldFocus a, b;
    Image other;
};

/// `grid`: of the image. `noise` and `off`: standard deviations, as sRGB values, of the noise of the halves'
/// mean and of the other image's error, in the left half of the image; the other image is ten times as wrong
/// in the right half.
/// With `by_pixel`, the errors of the pixels of a piece are independent.
Simulated simulated(const TileGrid& grid, double noise, double off, std::mt19937& random,
                    bool by_pixel = false) {
    const int width = grid.width, height = grid.height;
    Simulated out{.a = {}, .b = {}, .other = Image(width, height)};
    out.a.image = out.b.image = Image(width, height);
    std::normal_distribution<double> normal(0, 1);
    const int piece = by_pixel ? 1 : piece_px(width, height);
    const auto fill = [&](Image& image, int x0, int y0, double error) {
        const float value = linear_from_srgb(static_cast<float>(0.5 + error));
        for (int y = y0; y < y0 + piece; ++y) std::fill_n(image.pixel(x0, y), 3 * piece, value);
    };
    for (int y = 0; y < height; y += piece) {
        for (int x = 0; x < width; x += piece) {
            fill(out.a.image, x, y, std::sqrt(2) * noise * normal(random));
            fill(out.b.image, x, y, std::sqrt(2) * noise * normal(random));
            fill(out.other, x, y, (x < width / 2 ? 1 : 10) * off * normal(random));
        }
    }
    return out;
}

MeasuredError measured_by(const Simulated& of, const std::optional<Crop>& crop = {}) {
    return measured_error(of.a, of.b, crop, CheckedPixels(of.other.width, of.other.height, false),
                          CheckedPixels::Use::stating, &of.other);
}

/// Squared error of the image in which the other image has its weights.
double error_of(const Simulated& of, const std::vector<TileMix>& mix) {
    const int width = of.other.width, height = of.other.height;
    const TileGrid grid{width, height};
    double sum = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double w = mix[grid.at(x, y)].weight;
            const float views = (*of.a.image.pixel(x, y) + *of.b.image.pixel(x, y)) / 2;
            const float value = views + static_cast<float>(w) * (*of.other.pixel(x, y) - views);
            const double e = static_cast<double>(srgb_from_linear(value)) - 0.5;
            sum += e * e / (width * height);
        }
    }
    return sum;
}

/// A simulated image with its weights, its stated error and its true one.
struct Mixed {
    std::vector<TileMix> mix;
    StatedError stated;
    double is = 0;
};
Mixed mixed_of(const Simulated& of) {
    const MeasuredError measured = measured_by(of);
    Mixed out{.mix = mixed_tiles(measured), .stated = {}};
    out.stated = stated_error(measured, out.mix);
    out.is = error_of(of, out.mix);
    return out;
}

TEST(MixedImage, HasTheErrorThatIsStated) {
    std::mt19937 random(1);
    for (const double ratio :
         {0.1, 0.3, 1.0, 3.0}) {  // the other image's error in relation to the views' noise
        constexpr int trials = 50;
        constexpr double noise = 0.02;
        int inside = 0;
        double stated_sum = 0, sum = 0, views_sum = 0;
        for (int i = 0; i < trials; ++i) {
            const Simulated of = simulated(large, noise, ratio * noise, random);
            const auto [mix, stated, is] = mixed_of(of);
            inside += stated.low_mse <= is && is <= stated.high_mse ? 1 : 0;
            stated_sum += stated.mse();
            sum += is;
            views_sum += error_of(of, std::vector<TileMix>(large.count()));
            EXPECT_LT(stated.high_db() - stated.low_db(), 2.001);
        }
        // 95 of 100 intervals contain the error: less than 43 of 50 have a probability of 0.3 %.
        EXPECT_GE(inside, 43) << ratio;
        // The mean of 50 estimates, each with a standard deviation of at most 12 %, is known to 3 % at 1.7
        // standard deviations; pieces are not linear on the sRGB curve, which adds less than 1 %.
        EXPECT_NEAR(stated_sum / sum, 1, 0.04) << ratio;
        // Without an uncertainty of the weights, the left half would have the error n s / (n + s).
        const double n = noise * noise, s = ratio * ratio * n, left = n * s / (n + s),
                     right = n * 100 * s / (n + 100 * s);
        EXPECT_GT(sum / trials, 0.9 * (left + right) / 2) << ratio;
        EXPECT_LT(sum, views_sum) << ratio;
    }
}

TEST(MixedImage, IsStatedRightIfThePixelsOfAPieceAreIndependent) {
    // In large pieces the variance is estimated as too large, which must not change the stated error.
    constexpr TileGrid larger{512, 384};
    ASSERT_EQ(piece_px(larger.width, larger.height), 8);
    std::mt19937 random(4);
    constexpr double noise = 0.02;
    constexpr int trials = 5;
    double stated_sum = 0, sum = 0;
    for (int i = 0; i < trials; ++i) {
        const Simulated of = simulated(larger, noise, 0.3 * noise, random, true);
        const auto [mix, stated, is] = mixed_of(of);
        stated_sum += stated.mse();
        sum += is;
    }
    // Each of a million values of noise is known to a factor of sqrt(2), so their mean is known to 0.2 %.
    EXPECT_NEAR(stated_sum / sum, 1, 0.02);
}

TEST(MixedImage, IsNotStatedBetterThanIsKnown) {
    // In a single tile, the estimated error of a good image is often negative. The variance is estimated from
    // a few pieces, and the weight is chosen by it, so only nine in ten intervals need to contain the error:
    // less than 82 of 100 have a probability of 0.5 %.
    std::mt19937 random(3);
    for (const double ratio : {0.0, 0.02, 0.1}) {
        constexpr int trials = 100;
        constexpr double noise = 0.02;
        int inside = 0, inside_crop = 0;
        for (int i = 0; i < trials; ++i) {
            const Simulated of = simulated(small, noise, ratio * noise, random);
            const auto [mix, stated, is] = mixed_of(of);
            inside += stated.low_mse <= is && is <= stated.high_mse ? 1 : 0;
            // A part of the tile, with the weight that the whole tile got.
            const StatedError of_crop = stated_error(measured_by(of, Crop{8, 8, 32, 32}), mix);
            EXPECT_GT(of_crop.high_mse, 1e-2 * noise * noise) << ratio;
            inside_crop += of_crop.high_mse >= of_crop.mse() && of_crop.low_mse > 0 ? 1 : 0;
        }
        EXPECT_GE(inside, 82) << ratio;
        EXPECT_EQ(inside_crop, trials) << ratio;
    }
}

TEST(MixedImage, HasNoShareWhereTheViewsHaveNoNoise) {
    std::mt19937 random(2);
    Simulated of = simulated(large, 0, 0.01, random);
    const MeasuredError measured = measured_by(of);
    for (const TileMix& tile : mixed_tiles(measured)) EXPECT_EQ(tile.weight, 0);
    EXPECT_EQ(stated_error(measured, mixed_tiles(measured)).mse(), 0);
}

TEST(MixedImage, IsKnownBestAsTheMeanOfBoth) {
    // The error of the mean of two independent images is a quarter of their squared difference, whatever the
    // noise of either. From few pieces, no other weight is known well.
    const auto weight_with = [](int pieces) {
        TileError tile{.pixels = 4096, .noise_mse = 1e-4, .other_mse = 1e-6};
        const double noise = tile.noise_mse / pieces, product = tile.other_mse / pieces;
        tile.pieces.assign(static_cast<std::size_t>(pieces), {.noise_mse = noise,
                                                              .other_mse = product,
                                                              .of_noise = 4 * noise * noise,
                                                              .of_product = product * noise});
        for (const TileError& piece : tile.pieces) {
            tile.of_noise += piece.of_noise;
            tile.of_product += piece.of_product;
        }
        MeasuredError measured;
        measured.tiles = {tile};
        return mixed_tiles(measured)[0].weight;
    };
    EXPECT_NEAR(weight_with(16), 0.5, 0.15);
    EXPECT_GT(weight_with(10000), weight_with(16) + 0.05);
    EXPECT_GT(weight_with(1000000), 0.85);
}

// At the outline of a light that is far brighter than white, a pixel is white if any ray meets the light. Its
// noise is that of rays that all miss. It falls with 1 / n if the covered areas are uniformly distributed,
// but halves differ as often as that: a quarter of their squared difference would be half of the noise.
TEST(StatedError, HasTheNoiseOfOutlinesOfBrightLights) {
    constexpr int views_of_half = 16;
    constexpr float light = 200, dark = 0.05F;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0, 1);
    Simulated of{.a = {}, .b = {}, .other = Image(large.width, large.height)};
    of.a.image = of.b.image = Image(large.width, large.height);
    double is = 0;
    for (std::size_t k = 0; k < of.other.rgb.size(); k += 3) {
        const float covered = uniform(random);
        const auto seen = [&] {
            std::binomial_distribution<int> hits(views_of_half, static_cast<double>(covered));
            return dark + (light - dark) * static_cast<float>(hits(random)) / views_of_half;
        };
        const float a = seen(), b = seen();
        std::fill_n(of.a.image.rgb.begin() + static_cast<std::ptrdiff_t>(k), 3, a);
        std::fill_n(of.b.image.rgb.begin() + static_cast<std::ptrdiff_t>(k), 3, b);
        const float error = srgb_from_linear((a + b) / 2) - srgb_from_linear(dark + (light - dark) * covered);
        is += static_cast<double>(error * error) * 3 / static_cast<double>(of.other.rgb.size());
    }
    // If every hit is white, the estimate is 16 / 17 of the noise: 1 / (n + 1) - 1 / (2 n + 1) for
    // 1 / (2 n + 1). The rays miss some 1500 pixels, a number that varies by 2.6 %.
    EXPECT_NEAR(stated_error(measured_by(of)).mse() / is, 1, 0.1);
}

TEST(BiasedTiles, AreTheLargestErrorsUntilTheOthersAreSmall) {
    const TileGrid grid{.width = 4 * TileGrid::edge, .height = TileGrid::edge};
    MeasuredError measured;
    for (const double bias_mse : {1e-6, 8e-6, 4e-6, -1e-6})
        measured.tiles.push_back({.noise_mse = 1e-5, .bias_mse = bias_mse, .bias_deviation = 1e-6});
    using Tiles = std::vector<std::uint8_t>;
    // The mean of all is 3e-6, without the second 1e-6, and without the third as well 0.
    EXPECT_EQ(biased_tiles(measured, grid, 3.1e-6, 0), (Tiles{0, 0, 0, 0}));
    EXPECT_EQ(biased_tiles(measured, grid, 1.1e-6, 0), (Tiles{0, 1, 0, 0}));
    EXPECT_EQ(biased_tiles(measured, grid, 0.1e-6, 0), (Tiles{0, 1, 1, 0}));
    // Nothing is gained by rays where no error was found.
    EXPECT_EQ(biased_tiles(measured, grid, -1, 0), (Tiles{1, 1, 1, 0}));
    // A tile whose error exceeds its noise is wrong where it can be seen, however little it adds to the
    // image.
    measured.tiles[0] = {.noise_mse = 1e-7, .bias_mse = 1e-6, .bias_deviation = 4e-7};
    measured.tiles[3] = {.noise_mse = 1e-7, .bias_mse = 1e-6, .bias_deviation = 6e-7};
    EXPECT_EQ(biased_tiles(measured, grid, 1, 0), (Tiles{1, 0, 0, 0}));
    EXPECT_EQ(biased_tiles(measured, grid, 1, 0.9e-6), (Tiles{1, 0, 0, 0}));
    EXPECT_EQ(biased_tiles(measured, grid, 1, 1.1e-6), (Tiles{0, 0, 0, 0}));
}

// 20 pixels of a small image are wrong, such as those that a narrow shadow or reflection crosses between the
// records. If too few pixels are checked, none of these may be among them, and the stated error is too small.
TEST(MeasuredError, FindsFewWrongPixelsOfASmallImage) {
    constexpr int width = 160, height = 90, wrong = 20, images = 16;
    constexpr double residual = 0.1;  // ray minus record
    std::mt19937 random(7);
    std::uniform_int_distribution<std::size_t> anywhere(0, std::size_t{width} * height - 1);
    for (const bool random_rays : {false, true}) {
        const CheckedPixels checked(width, height, random_rays);
        double squares = 0;
        for (int i = 0; i < images; ++i) {
            FieldFocus half;
            half.image = Image(width, height);
            std::fill(half.image.rgb.begin(), half.image.rgb.end(), 0.5F);
            half.checks.resize(std::size_t{width} * height);
            for (int n = 0; n < wrong; ++n)
                half.checks[anywhere(random)] = {
                    .views = 1, .rays = 1, .sum = {residual, residual, residual}};
            double mse = 0;
            for (const PixelCheck& check : half.checks)
                mse += std::pow(check.mean(0) * srgb_slope(0.5), 2) / (width * height);
            const double stated =
                measured_error(half, half, {}, checked, CheckedPixels::Use::stating).bias_mse;
            squares += (stated / mse - 1) * (stated / mse - 1) / images;
        }
        // Half of the pixels are checked, so the number of wrong ones among them has a binomial distribution.
        EXPECT_LT(std::sqrt(squares), 1.3 / std::sqrt(wrong)) << random_rays;
    }
}

}  // namespace
}  // namespace postlens::test::mixed_image_test
