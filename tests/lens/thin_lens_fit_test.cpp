// Thin lenses fitted to circles of confusion, and to a range that must be sharp.
#include "lens/fits/thin_lens_fit.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include "core/error.h"
#include "lens/fits/sharp_range.h"
#include "lens/thin_lens.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test::thin_lens_fit_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<CocPair> measured(const ThinLens& lens, double focus_m, const std::vector<double>& depths_m,
                              double noise_mm, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, noise_mm);
    std::vector<CocPair> pairs;
    for (const double z : depths_m) {
        const double c = std::abs(coc_diameter_mm(lens, focus_m, z)) + (noise_mm > 0 ? noise(random) : 0);
        pairs.push_back({z, std::abs(c)});
    }
    return pairs;
}

const std::vector<double> both_sides = {0.5, 0.7, 1, 1.3, 1.7, 2.5, 4, 8, 20, infinity};

TEST(ThinLensFit, FindsTheLensThatMadeExactData) {
    for (const ThinLens lens : {ThinLens{50, 1.8}, ThinLens{24, 8}, ThinLens{200, 4}}) {
        for (const double focus_m : {0.9, 1.3, 5.0, 40.0}) {
            for (const std::vector<double>& depths : {both_sides, {0.6, 0.8}, {6.0, 9.0, 30.0}}) {
                const auto pairs = measured(lens, focus_m, depths, 0, 1);
                const ThinLensFit n_and_s = fit_thin_lens(pairs, {.focal_length_mm = lens.focal_length_mm});
                EXPECT_NEAR(n_and_s.f_number.value, lens.f_number, 1e-6 * lens.f_number);
                EXPECT_NEAR(n_and_s.focus_distance_m.value, focus_m, 1e-6 * focus_m);
                const ThinLensFit F_and_s = fit_thin_lens(pairs, {.f_number = lens.f_number});
                EXPECT_NEAR(F_and_s.focal_length_mm.value, lens.focal_length_mm, 1e-5 * lens.focal_length_mm);
                EXPECT_NEAR(F_and_s.focus_distance_m.value, focus_m, 1e-6 * focus_m);
                EXPECT_LT(n_and_s.rms_mm, 1e-9);
            }
        }
    }
}

TEST(ThinLensFit, FocusAtInfinityIsFound) {
    const ThinLensFit fit =
        fit_thin_lens(measured({50, 2}, infinity, {1, 2, 5, 20}, 0, 1), {.focal_length_mm = 50});
    EXPECT_GT(fit.focus_distance_m.value, 1e6);
    EXPECT_NEAR(fit.f_number.value, 2, 1e-6);
}

TEST(ThinLensFit, FocalLengthAndStopAreNotToldApart) {
    const ThinLens lens{85, 2.8};
    const ThinLensFit fit = fit_thin_lens(measured(lens, 2, both_sides, 1e-4, 7), {});
    ASSERT_EQ(fit.doubts.size(), 1U);
    EXPECT_NE(fit.doubts[0].find("F and n cannot be told apart"), std::string::npos);
    EXPECT_FALSE(fit.focal_length_mm.standard_error);
    EXPECT_FALSE(fit.f_number.standard_error);
    ASSERT_TRUE(fit.focus_distance_m.standard_error);
    EXPECT_NEAR(fit.focus_distance_m.value, 2, 5 * *fit.focus_distance_m.standard_error);
    // The example determines K = F^2 / (n (1 - F/s)) of the lens.
    const auto K = [](double F, double n) { return F * F / (n * (1 - F / 2000)); };
    EXPECT_NEAR(K(fit.focal_length_mm.value, fit.f_number.value) / K(85, 2.8), 1, 1e-3);
}

TEST(ThinLensFit, FocusNearerThanTheExampleIsFound) {
    // The lens of a telephone and one for stamps, focused nearer than the 50 mm of the example.
    const auto K = [](double F, double n, double s_mm) { return F * F / (n * (1 - F / s_mm)); };
    for (const auto& [lens, focus_m] : {std::pair{ThinLens{4, 2}, 0.03}, {ThinLens{8, 2.8}, 0.02}}) {
        const ThinLensFit fit = fit_thin_lens(measured(lens, focus_m, {0.015, 0.04, 0.1, 1}, 0, 1), {});
        EXPECT_NEAR(fit.focus_distance_m.value, focus_m, 1e-6 * focus_m);
        EXPECT_LT(fit.rms_mm, 1e-9);
        const double s_mm = focus_m * 1000;
        EXPECT_LT(fit.focal_length_mm.value, s_mm);
        EXPECT_NEAR(K(fit.focal_length_mm.value, fit.f_number.value, s_mm) /
                        K(lens.focal_length_mm, lens.f_number, s_mm),
                    1, 1e-6);
    }
}

TEST(ThinLensFit, StandardErrorsAreThoseOfRepeatedMeasurements) {
    // Compares the scatter of 400 fits with their stated errors. The scatter has a relative error of
    // 1/sqrt(800) = 4 %, the mean of the stated errors less.
    const ThinLens lens{50, 2};
    double sum_n = 0, sum_s = 0, stated_n = 0, stated_s = 0;
    constexpr int sets = 400;
    for (int i = 0; i < sets; ++i) {
        const auto fit = fit_thin_lens(
            measured(lens, 1.5, {0.6, 0.8, 1, 2.2, 3, 5, 12}, 0.002, 100U + static_cast<unsigned>(i)),
            {.focal_length_mm = 50});
        sum_n += std::pow(fit.f_number.value - 2, 2);
        sum_s += std::pow(fit.focus_distance_m.value - 1.5, 2);
        stated_n += std::pow(fit.f_number.standard_error.value(), 2);
        stated_s += std::pow(fit.focus_distance_m.standard_error.value(), 2);
    }
    // Four sigma of a ratio of variances with 8 % (scatter) and 3 % (stated: 400 fits with five degrees of
    // freedom).
    EXPECT_NEAR(sum_n / stated_n, 1, 0.35);
    EXPECT_NEAR(sum_s / stated_s, 1, 0.35);
}

TEST(ThinLensFit, SaysWhereDepthsDifferTooLittle) {
    const ThinLensFit fit =
        fit_thin_lens(measured({50, 2}, 1.5, {3, 3.0001, 3.0002, 3.0003}, 0, 1), {.focal_length_mm = 50});
    ASSERT_FALSE(fit.doubts.empty());
    EXPECT_NE(fit.doubts[0].find("depths differ too little"), std::string::npos) << fit.doubts[0];
    EXPECT_GT(fit.condition, 1e3);
    const ThinLensFit two = fit_thin_lens(measured({50, 2}, 1.5, {2, 3}, 0, 1), {.focal_length_mm = 50});
    ASSERT_EQ(two.doubts.size(), 1U);
    EXPECT_NE(two.doubts[0].find("no more pairs"), std::string::npos);
    EXPECT_FALSE(two.f_number.standard_error);
}

TEST(ThinLensFit, RefusesDataOfNoLens) {
    const auto refused = [](const std::vector<CocPair>& pairs, const ThinLensFitRequest& r, ExitCode code) {
        expect_refused([&] { (void)fit_thin_lens(pairs, r); }, code);
    };
    refused({}, {}, ExitCode::invalid_input);
    refused({{1, 0.1}}, {}, ExitCode::invalid_input);
    refused({{1, 0.1}, {1, 0.2}}, {}, ExitCode::invalid_input);
    refused({{1, 0}, {2, 0}, {3, 0}}, {}, ExitCode::invalid_input);
    refused({{1, 0.1}, {2, 0.2}}, {.focal_length_mm = 0}, ExitCode::wrong_arguments);
    refused({{1, 0.1}, {2, 0.2}}, {.f_number = -1}, ExitCode::wrong_arguments);
}

TEST(CocPairs, AreReadAndRefusedWithTheirLine) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "pairs.csv";
    std::ofstream(path) << "distance_m,coc_mm\n# a remark\n1.5,0.2\r\n\ninf,0.5\n";
    const auto pairs = read_coc_pairs(path);
    ASSERT_EQ(pairs.size(), 2U);
    EXPECT_EQ(pairs[0].distance_m, 1.5);
    EXPECT_EQ(pairs[0].coc_mm, 0.2);
    EXPECT_TRUE(std::isinf(pairs[1].distance_m));
    // Spreadsheets write a byte order mark before UTF-8.
    std::ofstream(path) << "\xEF\xBB\xBF"
                        << "distance_m,coc_mm\n1.5,0.2\n";
    EXPECT_EQ(read_coc_pairs(path).size(), 1U);
    for (const char* text : {"", "distance_m,coc_mm\n", "1\n", "1,x\n", "0,1\n", "-1,1\n", "1,-1\n",
                             "nan,1\n", "1,inf\n", "1,2,3\n"}) {
        std::ofstream(path) << text;
        expect_refused([&] { (void)read_coc_pairs(path); }, ExitCode::invalid_input, "pairs.csv");
    }
    EXPECT_THROW((void)read_coc_pairs(folder.path() / "missing.csv"), Error);
}

TEST(SharpRange, IsTheDepthOfFieldBackwards) {
    for (const auto& [near_m, far_m] : {std::pair{1.2, 4.0}, {0.8, 0.9}, {5.0, infinity}, {2.0, 30.0}}) {
        for (const double F_mm : {24.0, 50.0, 135.0}) {
            const SharpRange range = sharp_range(
                {.near_m = near_m, .far_m = far_m, .coc_limit_mm = 0.03, .focal_length_mm = F_mm});
            ASSERT_EQ(range.lenses.size(), 1U);
            const SharpLens& lens = range.lenses[0];
            ASSERT_GT(lens.f_number, 0.7) << near_m;
            const DepthOfField dof = depth_of_field({F_mm, lens.f_number}, range.focus_distance_m, 0.03);
            EXPECT_NEAR(dof.near_m, near_m, 1e-9 * near_m);
            // For an infinite far limit, the focus is at the hyperfocal distance, up to rounding.
            if (std::isinf(far_m)) {
                EXPECT_GT(dof.far_m, 1e12);
            } else {
                EXPECT_NEAR(dof.far_m, far_m, 1e-8 * far_m);
            }
        }
    }
}

TEST(SharpRange, SaysWhyNoneDoes) {
    // A 300 mm lens that is sharp from 1 to 3 m would need f/1000 or more, where the Airy disc exceeds any
    // limit.
    const SharpRange far_too_wide =
        sharp_range({.near_m = 1, .far_m = 3, .coc_limit_mm = 0.03, .focal_length_mm = 300});
    EXPECT_NE(far_too_wide.lenses[0].why_not.find("Airy"), std::string::npos);
    const SharpRange within =
        sharp_range({.near_m = 0.1, .far_m = 3, .coc_limit_mm = 0.03, .focal_length_mm = 105});
    EXPECT_NE(within.lenses[0].why_not.find("focal length"), std::string::npos);
    // If even the widest aperture has a larger sharp range than requested, it is accepted.
    const SharpRange easy =
        sharp_range({.near_m = 2, .far_m = 2.1, .coc_limit_mm = 0.03, .focal_length_mm = 14});
    EXPECT_EQ(easy.lenses[0].f_number, 0.7);
    EXPECT_TRUE(easy.lenses[0].why_not.empty());
    // At the largest f-number the Airy disc, 2.43934 lambda V/D, is as wide as the limit.
    const double stretch = 1 / (1 - 0.014 / easy.focus_distance_m);
    EXPECT_NEAR(2.43934 * 550e-6 * easy.lenses[0].largest_f_number * stretch, 0.03, 1e-6);
    EXPECT_THROW((void)sharp_range({.near_m = 3, .far_m = 2}), Error);
    EXPECT_THROW((void)sharp_range({.near_m = 0, .far_m = 2}), Error);
    EXPECT_THROW((void)sharp_range({.near_m = 1, .far_m = 2, .coc_limit_mm = 0}), Error);
}

}  // namespace
}  // namespace postlens::test::thin_lens_fit_test
