// The error of a noisy reference, and the error of an image above it, for a known truth.
#include "compare/metrics/noise_floor.h"

#include <cmath>
#include <gtest/gtest.h>

#include "compare/comparison.h"
#include "compare/comparison_text.h"
#include "tests/support/compare_pictures.h"

namespace postlens::test::noise_floor_test {
namespace {

constexpr int width = 96, height = 64;  // 96 blocks of 8 x 8
constexpr double values = 3.0 * width * height;

NoiseFloor floor_of(const Image& image, const Image& r1, const Image& r2) {
    return noise_floor(Picture(image), Picture(r1), Picture(r2), every_pixel(image));
}

// The truth plus a constant error.
Image shifted(const Image& truth, double error) {
    Image out = truth;
    for (float& v : out.rgb) v = static_cast<float>(static_cast<double>(v) + error);
    return out;
}

TEST(NoiseFloor, FindsTheNoiseOfTheReference) {
    constexpr double sigma = 0.01;
    const Image truth = waves(width, height);
    const NoiseFloor n = floor_of(truth, noisy(truth, sigma, 1), noisy(truth, sigma, 2));
    // (R1 - R2)^2 / 2 has mean sigma^2 and variance 2 sigma^4. The tolerance is five standard errors of its
    // mean, halved by the root.
    EXPECT_NEAR(n.reference_rmse / sigma, 1, 2.5 * std::sqrt(2 / values));
}

TEST(NoiseFloor, IsUnbiasedAndKnowsItsStandardError) {
    // The error is five times smaller than the noise, so the plain difference does not show it.
    constexpr double sigma = 0.02, error = 0.004;
    constexpr int runs = 200;
    const Image truth = waves(width, height), image = shifted(truth, error);
    // (I - R1)(I - R2) of one value has the variance sigma^4 + 2 sigma^2 error^2.
    const double expected_deviation =
        std::sqrt((std::pow(sigma, 4) + 2 * sigma * sigma * error * error) / values);
    double sum = 0, sum_of_squares = 0, sum_of_variances = 0;
    for (unsigned run = 0; run < runs; ++run) {
        const NoisyError e =
            floor_of(image, noisy(truth, sigma, 2 * run + 1), noisy(truth, sigma, 2 * run + 2)).linear;
        sum += e.mse;
        sum_of_squares += (e.mse - error * error) * (e.mse - error * error);
        sum_of_variances += e.standard_error * e.standard_error;
    }
    // Tolerances of four standard errors over the runs: of the estimate, of its variance (chi-squared with a
    // deviation of sqrt(2 / runs)), and of the stated variance (96 blocks, each the square of a normal
    // number).
    EXPECT_NEAR(sum / runs, error * error, 4 * expected_deviation / std::sqrt(runs));
    const double variance = expected_deviation * expected_deviation;
    EXPECT_NEAR(sum_of_squares / runs / variance, 1, 4 * std::sqrt(2.0 / runs));
    EXPECT_NEAR(sum_of_variances / runs / variance, 1, 4 * std::sqrt(2.0 / 96 / runs));
}

TEST(NoiseFloor, ClaimsNoMoreThanItCanKnow) {
    // For errors of zero, far below and near the noise: the stated lower bound of the PSNR above the noise
    // may exceed the true PSNR only as often as a normal number exceeds two standard errors.
    constexpr double sigma = 0.02;
    constexpr int runs = 100;
    const Image truth = waves(width, height);
    for (const double error : {1e-5, 1e-4, 1e-3, 1e-2}) {
        int too_much = 0, bounds = 0;
        for (unsigned run = 0; run < runs; ++run) {
            const NoisyError e = floor_of(shifted(truth, error), noisy(truth, sigma, 2 * run + 1),
                                          noisy(truth, sigma, 2 * run + 2))
                                     .linear;
            too_much += e.greatest_rms() < error ? 1 : 0;
            bounds += e.is_bound() ? 1 : 0;
            EXPECT_LT(e.least_rms(), e.greatest_rms());
        }
        // Expected are 2.3 % of 100 runs; 8 are 3.9 standard deviations more.
        EXPECT_LE(too_much, 8) << error;
        // The smallest error that exceeds two standard errors, 2 sigma^2 / sqrt(values), is 0.0024.
        if (error < 5e-4) {
            EXPECT_GE(bounds, 92) << error;
        } else if (error > 5e-3) {
            EXPECT_EQ(bounds, 0) << error;
        }
    }
}

TEST(NoiseFloor, TheEncodingsBiasIsPartOfTheBound) {
    // In a dark noisy image, the sRGB curve shifts the mean of both references equally, which products of
    // differences cannot detect. The truth must not get an error from this, nor a bound below the shift.
    constexpr double sigma = 0.02;
    const Image truth = constant_picture(256, 256, 0.06F);
    const NoiseFloor n = floor_of(truth, noisy(truth, sigma, 1), noisy(truth, sigma, 2));
    EXPECT_GT(n.encoded.mse, 2 * n.encoded.standard_error);  // the shift appears as an error
    EXPECT_TRUE(n.encoded.is_bound());
    // f = 1.055 x^(1/2.4) - 0.055 has f'' = -0.2564 x^(1/2.4 - 2), so the mean shifts by 0.0044, and the
    // bound must be larger.
    EXPECT_GT(n.encoded.greatest_rms(), 0.0044);
}

TEST(NoiseFloor, AnErrorInOneCornerIsNotLostAsChance) {
    constexpr double sigma = 0.01;
    const Image truth = waves(width, height);
    Image image = truth;
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) image.pixel(x, y)[0] += 0.1F;
    }
    const NoisyError e = floor_of(image, noisy(truth, sigma, 1), noisy(truth, sigma, 2)).linear;
    const double mse = 256 * 0.01 / values;
    // The variance is the sum of 2 sigma^2 d^2 over the corner and of sigma^4 over all values.
    const double deviation = std::sqrt(256 * 2 * sigma * sigma * 0.01 + values * std::pow(sigma, 4)) / values;
    EXPECT_NEAR(e.mse, mse, 4 * deviation);
    EXPECT_FALSE(e.is_bound());
}

TEST(NoiseFloor, TellsAPictureThatWasMadeFromAReference) {
    constexpr double sigma = 0.01;
    const Image truth = waves(width, height), r1 = noisy(truth, sigma, 1), r2 = noisy(truth, sigma, 2);
    EXPECT_LT(std::abs(floor_of(noisy(truth, 0.003, 3), r1, r2).preference), 4);
    // All 96 blocks agree, which gives at most sqrt(96) = 9.8, less some noise.
    EXPECT_LT(floor_of(noisy(r1, 0.003, 3), r1, r2).preference, -8);
    EXPECT_GT(floor_of(noisy(r2, 0.003, 3), r1, r2).preference, 8);
}

TEST(NoiseFloor, EqualFilesClaimNothing) {
    const Image truth = waves(width, height), r1 = noisy(truth, 0.01, 1), r2 = noisy(truth, 0.01, 2);
    const auto compared = [](const Image& i, const Image& a, const Image& b) {
        return compare_pictures({.image = i, .reference = a, .second_reference = b});
    };
    const Comparison same = compared(truth, r1, r1);
    EXPECT_TRUE(same.references_are_equal);
    EXPECT_FALSE(same.noise);
    for (const Comparison& c : {compared(r1, r1, r2), compared(r2, r1, r2)}) {
        EXPECT_TRUE(c.image_is_a_reference);
        ASSERT_TRUE(c.noise);
        // The noise is known, but no error above it is stated.
        for (const std::string& note : comparison_notes(c))
            EXPECT_EQ(note.find("above its noise"), std::string::npos) << note;
    }
    EXPECT_FALSE(compared(truth, r1, r2).image_is_a_reference);
}

TEST(NoiseFloor, AffectedPixelsHaveTheirOwn) {
    // Only the left half has noise, and only the left half is affected by the lens.
    const Image truth = waves(width, height);
    const auto left_noise = [&](unsigned seed) {
        const Image all = noisy(truth, 0.01, seed);
        Image out = truth;
        for (int y = 0; y < height; ++y) std::copy_n(all.pixel(0, y), 3 * width / 2, out.pixel(0, y));
        return out;
    };
    Image pinhole = truth;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width / 2; ++x) pinhole.pixel(x, y)[1] = 0;
    }
    const Comparison c = compare_pictures(
        {.image = truth, .reference = left_noise(1), .pinhole = pinhole, .second_reference = left_noise(2)});
    EXPECT_EQ(*c.affected_share, 0.5);
    // Half of the pixels have all of the noise; the sums are equal except for rounding.
    EXPECT_NEAR(c.affected_noise->reference_mse / c.noise->reference_mse, 2, 1e-9);
}

TEST(NoiseFloor, AFewPixelsAreEnoughForABound) {
    const Image truth = waves(3, 2);
    const NoiseFloor n = floor_of(truth, noisy(truth, 0.01, 1), noisy(truth, 0.01, 2));
    EXPECT_GT(n.linear.standard_error, 0);
    const NoiseFloor none = noise_floor(Picture(truth), Picture(truth), Picture(truth), PixelMask(6, 0));
    EXPECT_TRUE(none.linear.is_bound());
    EXPECT_TRUE(std::isnan(none.linear.greatest_rms()));
}

}  // namespace
}  // namespace postlens::test::noise_floor_test
