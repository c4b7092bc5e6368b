// Diffraction responses on the pixel grid: energy per pixel, many depths, rejected settings.
#include "lens/wave/diffraction_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/threads.h"
#include "lens/lommel/lommel.h"
#include "lens/lommel/quadrature.h"
#include "lens/wave/wave_scale.h"
#include "tests/support/refusal.h"

namespace postlens::test::diffraction_response_test {
namespace {

constexpr double pi = std::numbers::pi;

struct Case {
    double radius_px, v_per_px;  ///< of the geometric disc
    double centre_x, centre_y;
};

ResponseGrid pixels(const Case& c, int half, const PixelEnergySettings& settings = {}) {
    ResponseGrid grid(-half, -half, 2 * half + 1, 2 * half);
    const double reach = reach_px(grid, c.centre_x, c.centre_y, settings);
    const RadialEnergy energy(c.radius_px * c.v_per_px, reach * c.v_per_px);
    fill_pixel_energy(RadialProfile({{&energy, c.v_per_px, 1.0}}), c.centre_x, c.centre_y, settings, grid);
    return grid;
}

double sum_of(const ResponseGrid& grid) {
    return std::accumulate(grid.share.begin(), grid.share.end(), 0.0);
}

double peak_of(const ResponseGrid& grid) {
    return *std::max_element(grid.share.begin(), grid.share.end());
}

double worst_difference(const ResponseGrid& a, const ResponseGrid& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.share.size(); ++i)
        worst = std::max(worst, std::abs(a.share[i] - b.share[i]));
    return worst;
}

TEST(RadialProfile, ARowOfSmoothedEnergiesIsEachByItself) {
    const RadialEnergy fine(300, 700), coarse(3, 200);
    const RadialProfile profile(
        {{&fine, 5.0, 0.7}, {&coarse, 0.4, 0.3}});  // the second is too coarse to be smoothed
    const double begin_px = 3.1, width_px = 0.7 / 3;
    const std::vector<double> row = profile.smoothed_row(begin_px, width_px, 500);
    for (std::size_t i = 0; i < row.size(); ++i) {
        const double radius_px = begin_px + static_cast<double>(i) * width_px / RadialProfile::row_steps;
        ASSERT_NEAR(row[i], profile.smoothed_within(radius_px, width_px), 1e-12) << i;
    }
}

TEST(PixelEnergy, IsTheIntegralOfTheIntensityOverThePixel) {
    for (const Case& c :
         {Case{0, 4, 0.3, 0.1}, Case{0, 4, 0.5, 0.5}, Case{1.3, 5, 0, 0}, Case{6, 5, 0.2, 0.9}}) {
        const ResponseGrid grid = pixels(c, 8);
        for (const auto& [i, j] : {std::pair{8, 8}, {7, 8}, {10, 5}, {2, 9}, {14, 14}}) {
            double sum = 0;
            for (const GaussNode& a : gauss_legendre_16()) {
                for (const GaussNode& b : gauss_legendre_16()) {
                    const double x = grid.x_begin + i + a.x - c.centre_x;
                    const double y = grid.y_begin + j + b.x - c.centre_y;
                    sum += a.weight * b.weight *
                           lommel_intensity(c.radius_px * c.v_per_px, std::hypot(x, y) * c.v_per_px);
                }
            }
            // The energy per square pixel is dE = I v dv / 2 over 2 pi r dr, that is I v_per_px^2 / (4 pi).
            // Gauss' rule is exact for fringes this wide, so the difference is the error of the default
            // sampling.
            const double exact = sum * c.v_per_px * c.v_per_px / (4 * pi);
            EXPECT_NEAR(grid.at(i, j), exact, 5e-5 * peak_of(grid)) << c.radius_px << " " << i << " " << j;
        }
    }
}

TEST(PixelEnergy, DefaultSamplingHasConverged) {
    // Fringes from much wider to much finer than a pixel. The error is below 5e-4 of the brightest pixel
    // (measured: at most 4.5e-4, for an edge a tenth of a pixel wide; 1e-5 or less for edges wider than a
    // pixel).
    for (const Case& c :
         {Case{0, 0.5, 0.3, 0.21}, Case{0, 60, 0.001, 0}, Case{2, 60, 0.3, 0.21}, Case{6, 400, 0.3, 0.21},
          Case{20, 5, 0.3, 0.21}, Case{20, 60, 0.3, 0.21}, Case{20, 60, 0, 0}}) {
        const int half = static_cast<int>(c.radius_px) + 5;
        const ResponseGrid grid = pixels(c, half), fine = pixels(c, half, {.nodes = 128, .near_px = 6});
        EXPECT_LT(worst_difference(grid, fine), 5e-4 * peak_of(fine)) << c.radius_px << " " << c.v_per_px;
    }
}

TEST(PixelEnergy, SymmetricCentresTakeAShortcutToTheSamePixels) {
    // A centre displaced by 1e-9 px does not take the shortcut. The displacement changes pixels by 1e-9 of
    // the steepest gradient, which is at most the peak per fringe, with 60 fringes per pixel. No border of a
    // pixel touches the circle at which the sampling changes.
    const PixelEnergySettings settings{.near_px = 4.3};
    for (const double middle : {0.0, 0.5, 3.0, -2.5}) {
        for (const Case& c : {Case{0, 60, middle, middle}, Case{7, 20, middle, middle}}) {
            Case beside = c;
            beside.centre_x += 1e-9;
            const ResponseGrid a = pixels(c, 12, settings), b = pixels(beside, 12, settings);
            EXPECT_LT(worst_difference(a, b), 1e-6 * peak_of(a)) << middle << " " << c.radius_px;
        }
    }
}

TEST(PixelEnergy, SumsToWhatTheFrameEncloses) {
    // The sum lies between the energies within the frame's inscribed and circumscribed circles.
    for (const Case& c : {Case{0, 60, 0.5, 0}, Case{3, 60, 0.5, 0}, Case{9, 1, 0.5, 0}}) {
        const ResponseGrid grid = pixels(c, 12);
        const RadialEnergy energy(c.radius_px * c.v_per_px, 18 * c.v_per_px);
        EXPECT_GT(sum_of(grid), energy.within(11.999 * c.v_per_px));
        EXPECT_LT(sum_of(grid), energy.within(17.4 * c.v_per_px));
    }
}

FocusGeometry geometry() {
    return focus_geometry({.focal_length_mm = 50, .f_number = 1.8}, 2, Framing::keep,
                          {.distance_mm = 50, .pixel_pitch_mm = 0.01875});
}

TEST(WaveScale, IsThatOfTheClosedForms) {
    // u = (2 pi / lambda) (F / 2n)^2 (1/s - 1/z), v = pi r / (lambda V / D).
    const ThinLens lens{.focal_length_mm = 85, .f_number = 1.4};
    const double D_m = 0.085 / 1.4, lambda_m = 550e-9, V_mm = image_distance_mm(lens, 0.85);
    const WaveScale scale = wave_scale(lens, 0.85, 3, 0.005, 550);
    EXPECT_NEAR(scale.u, 2 * pi / lambda_m * D_m * D_m / 4 * (1 / 0.85 - 1 / 3.0), 1e-8);
    EXPECT_NEAR(scale.v_per_px, pi * 0.005e-3 * D_m / (lambda_m * V_mm * 1e-3), 1e-12);
    // The film of `breathing` gives the same scale. v = u at the geometric edge.
    const FocusGeometry g = focus_geometry(lens, 0.85, Framing::breathing, {85, 0.005});
    const WaveScale of_film = wave_scale(g, 1 / 3.0, 550);
    EXPECT_NEAR(of_film.u, scale.u, 1e-8);
    EXPECT_NEAR(of_film.v_per_px, scale.v_per_px, 1e-12);
    EXPECT_NEAR(of_film.v_per_px * g.coc_diameter_px(1 / 3.0) / 2, scale.u, 1e-8);
    // `keep` has the film distance d of the trace instead of V.
    const WaveScale kept = wave_scale(focus_geometry(lens, 0.85, Framing::keep, {85, 0.005}), 1 / 3.0, 550);
    EXPECT_NEAR(kept.v_per_px / scale.v_per_px, V_mm / 85, 1e-12);
    EXPECT_NEAR(kept.u, scale.u, 1e-8);
}

TEST(Spectrum, EveryChannelsWeightsAreOneInSum) {
    const Spectrum bands = channel_bands();
    for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0, mean_nm = 0;
        for (const SpectralLine& line : bands) {
            EXPECT_GE(line.weight[c], 0);
            sum += line.weight[c];
            mean_nm += line.weight[c] * line.wavelength_nm;
        }
        EXPECT_NEAR(sum, 1, 1e-15);
        // The mean wavelength of a band is kept to a few nm; the blue band is cut off below 440 nm.
        EXPECT_NEAR(mean_nm, (std::array{611.0, 549.0, 464.0}[c]), 8);
    }
}

TEST(DiffractionResponses, HoldTheStatedShareOfTheEnergy) {
    const std::vector<double> cocs = {0, 1, -6, 30};
    for (const double tail : {0.05, 0.01}) {
        const auto lost = diffraction_responses(geometry(), cocs, {.tail = tail, .fold_tail = false});
        const auto folded = diffraction_responses(geometry(), cocs, {.tail = tail});
        for (std::size_t d = 0; d < cocs.size(); ++d) {
            for (std::size_t c = 0; c < 3; ++c) {
                // The pixels hold more energy than the circle that they cover.
                EXPECT_GT(lost[d].loss[c], 0);
                EXPECT_LT(lost[d].loss[c], tail);
                EXPECT_NEAR(sum_of(lost[d].channel[c]), 1 - lost[d].loss[c], 1e-12);
                EXPECT_NEAR(sum_of(folded[d].channel[c]), 1, 1e-12);
            }
        }
    }
}

TEST(DiffractionResponses, RedSpreadsFurtherThanBlue) {
    // At f/16 Airy discs are wider than a pixel.
    const FocusGeometry g = focus_geometry({.focal_length_mm = 50, .f_number = 16}, 2, Framing::keep,
                                           {.distance_mm = 50, .pixel_pitch_mm = 0.004});
    const std::vector<double> cocs = {0};
    const auto r = diffraction_responses(g, cocs, {.centre_x = 0.5, .centre_y = 0.5});
    EXPECT_GT(peak_of(r[0].channel[1]), 1.1 * peak_of(r[0].channel[0]));
    EXPECT_GT(peak_of(r[0].channel[2]), 1.1 * peak_of(r[0].channel[1]));
}

TEST(DiffractionResponses, AreTheSameBeforeAndBehindTheFocus) {
    const std::vector<double> cocs = {-17, 17};
    const auto r = diffraction_responses(geometry(), cocs, {.centre_x = 0.3});
    EXPECT_EQ(r[0].channel[1].share, r[1].channel[1].share);
}

TEST(DiffractionResponses, SameBitsForAnyNumberOfThreads) {
    const std::vector<double> cocs = {0, 0.3, 2, 9, 21, 33};
    const auto run = [&](int threads) {
        const ThreadLimit limit(threads);
        return diffraction_responses(geometry(), cocs, {.centre_x = 0.25, .centre_y = 0.75});
    };
    const auto one = run(1), four = run(4);
    for (std::size_t d = 0; d < cocs.size(); ++d) {
        for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(one[d].channel[c].share, four[d].channel[c].share);
    }
}

TEST(DiffractionResponses, RefuseWhatTheyCannotMake) {
    const auto refused = [](const FocusGeometry& g, double coc, const DiffractionSettings& s, ExitCode code,
                            const std::string& part) {
        expect_refused([&] { (void)diffraction_responses(g, std::vector{coc}, s); }, code, part);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    FocusGeometry pinhole = geometry();
    pinhole.aperture_radius_m = 0;
    refused(pinhole, 1, {}, ExitCode::wrong_arguments, "aperture of some width");
    refused(geometry(), nan, {}, ExitCode::wrong_arguments, "circle of confusion");
    refused(geometry(), 1, {.tail = 0}, ExitCode::wrong_arguments, "tail");
    refused(geometry(), 1, {.max_radius_px = 1e6}, ExitCode::wrong_arguments, "radius");
    refused(geometry(), 1, {.spectrum = {{.wavelength_nm = 1}}}, ExitCode::wrong_arguments, "wavelength");
    refused(geometry(), 1e6, {}, ExitCode::wrong_arguments, "too far out of focus");
    // 16384 px with a lens of 200 m diameter: v reaches 1e10.
    FocusGeometry vast = geometry();
    vast.aperture_radius_m = 100;
    refused(vast, 0, {.tail = 1e-9, .max_radius_px = 16384}, ExitCode::out_of_memory, "needs");
    EXPECT_THROW((void)equal_lines({}), Error);
}

}  // namespace
}  // namespace postlens::test::diffraction_response_test
