// Error measures that are sums over pixels, SSIM, the selection of pixels, and limits.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/quality.hpp>

#include "compare/comparison.h"
#include "compare/comparison_text.h"
#include "compare/drawing/error_map.h"
#include "compare/drawing/side_by_side.h"
#include "compare/metrics/ssim.h"
#include "core/error.h"
#include "core/threads.h"
#include "pictures/srgb.h"
#include "tests/support/compare_pictures.h"

namespace postlens::test::compare_test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

PixelErrors errors_of(const Image& image, const Image& reference) {
    return pixel_errors(Picture(image), Picture(reference), every_pixel(image));
}

TEST(PixelErrors, AConstantOffsetHasClosedForms) {
    // The values are binary fractions, so all differences and sums are exact.
    const PixelErrors e = errors_of(constant_picture(30, 20, 0.75F), constant_picture(30, 20, 0.5F));
    EXPECT_EQ(e.rmse, 0.25);
    EXPECT_EQ(e.pixels, 600U);
    EXPECT_NEAR(e.relmse, 0.0625 / (0.25 + 0.01), 1e-15);  // tolerance: a few roundings in double
    EXPECT_NEAR(e.relmse_trimmed, e.relmse, 1e-15);
    // The sRGB curve in double. The program computes it in float, with an error of 6e-8 per value, which
    // makes 20/ln 10 * 1.2e-7 / 0.14 dB.
    const auto curve = [](double v) { return 1.055 * std::pow(v, 1 / 2.4) - 0.055; };
    EXPECT_NEAR(e.psnr_db, -20 * std::log10(curve(0.75) - curve(0.5)), 1e-5);
}

TEST(PixelErrors, PsnrSeesClampedEncodedValues) {
    EXPECT_EQ(errors_of(constant_picture(8, 8, 3), constant_picture(8, 8, 1)).psnr_db,
              std::numeric_limits<double>::infinity());
    EXPECT_EQ(errors_of(constant_picture(8, 8, 1), constant_picture(8, 8, 0)).psnr_db, 0);
    EXPECT_EQ(errors_of(constant_picture(8, 8, 3), constant_picture(8, 8, 1)).rmse, 2);
}

TEST(PixelErrors, AgreesWithOpenCvsPsnr) {
    const Image reference = waves(61, 47), image = noisy(reference, 0.01, 1);
    const Image a = encoded_srgb(image), b = encoded_srgb(reference);
    const auto mat = [](const Image& i) {
        return cv::Mat(i.height, i.width, CV_32FC3, const_cast<float*>(i.rgb.data()));
    };
    // OpenCV sums the same squares in another order, which changes a few roundings in double.
    EXPECT_NEAR(errors_of(image, reference).psnr_db, cv::PSNR(mat(a), mat(b), 1.0), 1e-9);
}

TEST(PixelErrors, RelmseByHand) {
    const Image image = constant_picture(1, 1, 0.5F, 0, 2), reference = constant_picture(1, 1, 0.25F, 1, 0);
    // The three channels: (1/16) / (1/16 + 0.01), 1 / 1.01, 4 / 0.01.
    EXPECT_NEAR(errors_of(image, reference).relmse, (0.0625 / 0.0725 + 1 / 1.01 + 400) / 3, 1e-12);
}

TEST(PixelErrors, TrimmingDropsTheWorstThousandth) {
    Image image = constant_picture(100, 20, 0.5F);
    const Image reference = image;
    for (int x = 0; x < 3; ++x) image.pixel(10 * x, x)[1] = 0.5F + 0.25F * static_cast<float>(x + 1);
    const auto pixel = [](double d) { return d * d / 0.26 / 3; };
    const PixelErrors e = errors_of(image, reference);
    EXPECT_NEAR(e.relmse, (pixel(0.25) + pixel(0.5) + pixel(0.75)) / 2000, 1e-15);
    EXPECT_NEAR(e.relmse_trimmed, pixel(0.25) / 1998, 1e-15);  // two of 2000 pixels are dropped
    // Of fewer than a thousand pixels, none is dropped.
    const PixelErrors few = errors_of(constant_picture(9, 9, 0), constant_picture(9, 9, 1));
    EXPECT_DOUBLE_EQ(few.relmse, few.relmse_trimmed);
}

TEST(Ssim, EqualPicturesGiveExactlyOne) {
    const Image a = encoded_srgb(noisy(waves(150, 90), 0.1, 2));
    const auto map = ssim_map(a, a, every_pixel(a));
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            const float v = map[static_cast<std::size_t>(y * a.width + x)];
            const bool inside = x >= 5 && x < a.width - 5 && y >= 5 && y < a.height - 5;
            EXPECT_TRUE(inside ? v == 1.0F : std::isnan(v)) << x << " " << y;
        }
    }
}

TEST(Ssim, OfTwoConstantsIsTheLuminanceTerm) {
    const Image a = constant_picture(40, 30, 0.25F), b = constant_picture(40, 30, 0.5F);
    const double mean = mean_over(ssim_map(a, b, every_pixel(a)), 40, every_pixel(a));
    // SSIM is (2 a b + C1) / (a^2 + b^2 + C1) here. The float weights of the window sum to 1 within 1e-6.
    EXPECT_NEAR(mean, (2 * 0.25 * 0.5 + 1e-4) / (0.0625 + 0.25 + 1e-4), 1e-5);
}

TEST(Ssim, AgreesWithOpenCvInsideThePicture) {
    const Image a = encoded_srgb(noisy(waves(170, 140), 0.05, 3)),
                b = encoded_srgb(noisy(waves(170, 140), 0.05, 4));
    const auto luma = [](const Image& i) {
        cv::Mat out(i.height, i.width, CV_32FC1);
        for (int y = 0; y < i.height; ++y) {
            for (int x = 0; x < i.width; ++x) {
                const float* p = i.pixel(x, y);
                out.at<float>(y, x) = 255 * (0.2126F * p[0] + 0.7152F * p[1] + 0.0722F * p[2]);
            }
        }
        return out;
    };
    cv::Mat theirs;
    cv::quality::QualitySSIM::compute(luma(a), luma(b), theirs);  // its constants assume values up to 255
    theirs.convertTo(theirs, CV_32F);
    const auto ours = ssim_map(a, b, every_pixel(a));
    for (int y = 5; y < a.height - 5; ++y) {
        for (int x = 5; x < a.width - 5; ++x) {
            // OpenCV subtracts squares of up to 1 in float (error 2e-7) and divides by variances of at least
            // 0.001.
            EXPECT_NEAR(ours[static_cast<std::size_t>(y * a.width + x)], theirs.at<float>(y, x), 1e-3);
        }
    }
}

TEST(Ssim, PicturesSmallerThanTheWindowHaveNone) {
    const Comparison c = compare_pictures({.image = waves(10, 40), .reference = waves(10, 40)});
    EXPECT_TRUE(std::isnan(c.whole.ssim));
    EXPECT_TRUE(c.identical);
}

TEST(Comparison, AffectedPixelsAreThoseWherePinholeAndReferenceDiffer) {
    // A quarter of the reference differs from the pinhole by more than 1/255, and one row by less.
    const Image pinhole = constant_picture(40, 40, 0.5F);
    Image reference = pinhole, image = pinhole;
    const float step = srgb_from_linear(0.5F) + 0.9F / 255;
    for (int x = 0; x < 40; ++x) reference.pixel(x, 39)[0] = linear_from_srgb(step);
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 20; ++x) {
            reference.pixel(x, y)[2] = 0.75F;
            image.pixel(x, y)[2] = 0.625F;
        }
    }
    const Comparison c = compare_pictures({.image = image, .reference = reference, .pinhole = pinhole});
    ASSERT_TRUE(c.affected && c.affected_share);
    EXPECT_EQ(*c.affected_share, 0.25);
    EXPECT_EQ(c.affected->errors.pixels, 400U);
    EXPECT_NEAR(c.affected->errors.rmse, 0.125 / std::sqrt(3.0), 1e-15);
    EXPECT_NEAR(c.pinhole_affected->rmse, 0.25 / std::sqrt(3.0), 1e-15);
    EXPECT_GT(c.whole.errors.psnr_db, c.affected->errors.psnr_db);
    EXPECT_GT(c.affected->flip_ldr, c.whole.flip_ldr);
    EXPECT_LT(c.affected->ssim, c.whole.ssim);
    const Comparison none = compare_pictures({.image = image, .reference = pinhole, .pinhole = pinhole});
    EXPECT_EQ(*none.affected_share, 0);
    EXPECT_TRUE(std::isnan(none.affected->errors.psnr_db));
}

TEST(Comparison, NonfinitePixelsAreCountedAndLeftOut) {
    const Image reference = waves(64, 48);
    Image image = reference;
    for (float& v : image.rgb) v += 0.125F;
    const Comparison clean = compare_pictures({.image = image, .reference = reference});
    Image damaged_reference = reference;
    image.pixel(3, 4)[1] = nan;
    image.pixel(60, 40)[0] = -infinity;
    image.pixel(5, 5)[2] = infinity;
    damaged_reference.pixel(5, 5)[0] = nan;
    damaged_reference.pixel(20, 20)[0] = infinity;
    const Comparison c = compare_pictures({.image = image, .reference = damaged_reference});
    EXPECT_EQ(c.nonfinite.image, 3U);
    EXPECT_EQ(c.nonfinite.reference, 2U);
    EXPECT_EQ(c.nonfinite.any, 4U);
    EXPECT_EQ(c.nonfinite.image_only, 2U);
    EXPECT_EQ(c.whole.errors.pixels, 64U * 48 - 4);
    EXPECT_NEAR(c.whole.errors.rmse, clean.whole.errors.rmse, 1e-7);
    EXPECT_TRUE(std::isfinite(c.whole.ssim) && std::isfinite(c.whole.flip_ldr) &&
                std::isfinite(c.whole.flip_hdr));
    EXPECT_TRUE(failed_limits(c, {}).empty());
    EXPECT_EQ(failed_limits(c, {.least_psnr_db = 1}).size(), 1U);

    const Image nothing = constant_picture(16, 16, nan);
    const Comparison none = compare_pictures({.image = nothing, .reference = nothing});
    EXPECT_TRUE(std::isnan(none.whole.errors.psnr_db) && std::isnan(none.whole.flip_hdr));
    EXPECT_EQ(failed_limits(none, {.least_psnr_db = 1, .greatest_relmse = 1, .greatest_flip = 1}).size(), 3U);
}

TEST(Comparison, LimitsSayWhichAndByHowMuch) {
    const Comparison c = compare_pictures(
        {.image = constant_picture(16, 16, 0.75F), .reference = constant_picture(16, 16, 0.5F)});
    const double psnr = c.whole.errors.psnr_db, relmse = c.whole.errors.relmse;
    EXPECT_TRUE(
        failed_limits(c, {.least_psnr_db = psnr, .greatest_relmse = relmse, .greatest_flip = 1}).empty());
    const auto failed =
        failed_limits(c, {.least_psnr_db = psnr + 1.5, .greatest_relmse = relmse / 2, .greatest_flip = 0});
    ASSERT_EQ(failed.size(), 3U);
    EXPECT_EQ(failed[0].rfind("PSNR is 1.500 dB below", 0), 0U) << failed[0];
    EXPECT_EQ(failed[1].rfind("relMSE is 0.1202 above", 0), 0U) << failed[1];  // 0.0625 / 0.26 / 2
    EXPECT_EQ(failed[2].rfind("FLIP is", 0), 0U) << failed[2];
}

TEST(Comparison, SizesMustAgree) {
    EXPECT_THROW((void)compare_pictures({.image = waves(8, 8), .reference = waves(8, 9)}), Error);
    EXPECT_THROW(
        (void)compare_pictures({.image = waves(8, 8), .reference = waves(8, 8), .pinhole = waves(9, 8)}),
        Error);
}

TEST(Comparison, SameBitsForAnyNumberOfThreads) {
    const Image truth = waves(333, 217);
    const auto figures = [&](int threads) {
        const ThreadLimit limit(threads);
        const Comparison c = compare_pictures({.image = noisy(truth, 0.05, 1),
                                               .reference = noisy(truth, 0.01, 2),
                                               .pinhole = noisy(truth, 0.02, 3),
                                               .second_reference = noisy(truth, 0.01, 4)});
        const Figures &w = c.whole, &a = *c.affected;
        const Image map = error_map(noisy(truth, 0.05, 1), truth);
        std::vector<double> out{w.errors.rmse,
                                w.errors.relmse,
                                w.errors.relmse_trimmed,
                                w.errors.psnr_db,
                                w.ssim,
                                w.flip_ldr,
                                w.flip_hdr,
                                a.errors.rmse,
                                a.ssim,
                                a.flip_ldr,
                                c.noise->encoded.mse,
                                c.noise->encoded.standard_error,
                                c.noise->reference_mse,
                                c.affected_noise->linear.mse};
        out.insert(out.end(), map.rgb.begin(), map.rgb.end());
        return out;
    };
    const auto one = figures(1);
    EXPECT_EQ(figures(2), one);
    EXPECT_EQ(figures(5), one);
}

TEST(ErrorMap, ColoursFollowTheDifference) {
    const Image reference = constant_picture(500, 40, 0.5F);
    Image image = reference;
    // The errors from left to right: none, small, large, NaN.
    const float encoded = srgb_from_linear(0.5F);
    for (int y = 0; y < 40; ++y) {
        for (int x = 100; x < 500; ++x)
            image.pixel(x, y)[0] = x < 200 ? linear_from_srgb(encoded + 1.0F / 255) : x < 300 ? 0.0F : nan;
    }
    const Image map = error_map(image, reference);
    const ImageSize size = error_map_size({500, 40});
    EXPECT_EQ(map.width, size.width);
    EXPECT_EQ(map.height, size.height);
    // The colour map Viridis runs from dark violet through green to yellow, with increasing luminance.
    const auto luminance = [&](int x) {
        const float* p = map.pixel(x, 20);
        return 0.2126F * p[0] + 0.7152F * p[1] + 0.0722F * p[2];
    };
    EXPECT_LT(luminance(50), luminance(150));
    EXPECT_LT(luminance(150), luminance(250));
    EXPECT_EQ(std::vector<float>(map.pixel(400, 20), map.pixel(400, 20) + 3), (std::vector<float>{1, 0, 1}));
}

}  // namespace
}  // namespace postlens::test::compare_test
