// The response to one point and its measures, the f-number at which diffraction dominates, and the values of
// --impulse.
#include "lens/wave/lens_response.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include "core/error.h"
#include "lens/ellipse_coverage.h"
#include "lens/lommel/lommel.h"
#include "lens/wave/crossover.h"
#include "tests/support/refusal.h"

namespace postlens::test::lens_response_test {
namespace {

constexpr double pi = std::numbers::pi, infinity = std::numeric_limits<double>::infinity();
const Impulse diffraction{.kind = ImpulseKind::diffraction};

TEST(LensResponse, InFocusHasAirysFigures) {
    // For f/8, s = 1 m and F = 50 mm: V = 52.63 mm, D = 6.25 mm.
    const LensResponse r = lens_response({.lens = {50, 8}, .pixel_pitch_mm = 0.001, .impulse = diffraction});
    const double wave_px = 550e-6 * (50 / 0.95) / 6.25 / 0.001;  // lambda V/D
    EXPECT_EQ(r.u, 0);
    EXPECT_NEAR(r.v_per_px, pi / wave_px, 1e-12);
    EXPECT_NEAR(r.airy_diameter_px, 2.43934 * wave_px, 1e-4 * wave_px);
    // (2 J1(v) / v)^2 = 1/2 at v = 1.61634, so the full width is 1.02899 lambda V/D. The profile has four
    // points per unit of v with linear interpolation: its error is h^2/8 times a second derivative of 0.3,
    // over a slope of 0.4.
    EXPECT_NEAR(r.fwhm_px.value(), 1.02899 * wave_px, 2 * 0.006 / r.v_per_px);
    // The encircled energy is 1/2 at v = 1.6784.
    EXPECT_NEAR(r.half_energy_diameter_px.value() * r.v_per_px / 2, 1.6784, 0.006);
    EXPECT_NEAR(r.profile.front().intensity, 1, 1e-12);
    EXPECT_GT(r.energy_in_frame, 0.99);
    EXPECT_LT(r.energy_in_frame, 1);
}

TEST(LensResponse, ProfileIsLommels) {
    const LensResponse r = lens_response(
        {.lens = {50, 2.8}, .depth_m = 1.05, .pixel_pitch_mm = 0.005, .impulse = diffraction, .size_px = 41});
    ASSERT_NE(r.u, 0);
    for (std::size_t i = 0; i < r.profile.size(); i += 37) {
        const RadialSample& s = r.profile[i];
        EXPECT_NEAR(s.v, s.radius_px * r.v_per_px, 1e-9);
        EXPECT_NEAR(s.intensity, lommel_intensity(r.u, s.v), 1e-12);
        EXPECT_NEAR(s.encircled, lommel_encircled_energy(r.u, s.v), 1e-6);
    }
    EXPECT_NEAR(r.profile.back().radius_px, 20.5, 1e-12);
}

TEST(LensResponse, DiscIsTheExactCoverage) {
    for (const int size : {41, 40, 15}) {
        const LensResponse r = lens_response({.lens = {50, 2.8}, .depth_m = 1.4, .size_px = size});
        const double middle = size % 2 == 0 ? 0 : 0.5;
        const Ellipse disc = Ellipse::disc(std::abs(r.coc_px) / 2);
        for (int j = 0; j < size; j += 3) {
            for (int i = 0; i < size; i += 2) {
                const double share = ellipse_coverage_reference(disc, middle, middle, r.grid.x_begin + i,
                                                                r.grid.y_begin + j, 200);
                // 200 x 200 points give the coverage of a pixel to 1/200.
                EXPECT_NEAR(r.grid.at(i, j), share, 1.0 / 200 / disc.area_px2())
                    << size << " " << i << " " << j;
            }
        }
        EXPECT_NEAR(r.fwhm_px.value_or(std::abs(r.coc_px)), std::abs(r.coc_px), 1e-12);
    }
}

TEST(LensResponse, TheFrameHoldsAllLightOfAGeometricResponse) {
    LensResponseRequest q{.lens = {50, 2}, .focus_distance_m = 2, .depth_m = 1};
    EXPECT_EQ(lens_response(q).grid.width, 39);  // a CoC of 34.2 px
    // The rim is displaced by (1/2 - 1 + 3) / (1/2 - 1) = -5 times the radius of the CoC.
    q.impulse.spherical = 3;
    const LensResponse aberrated = lens_response(q);
    EXPECT_EQ(aberrated.grid.width, 2 * (86 + 1) + 1);
    EXPECT_NEAR(aberrated.energy_in_frame, 1, 1e-6);
    q.impulse = {.squeeze = 0.5};
    EXPECT_NEAR(lens_response(q).energy_in_frame, 1, 1e-6);
    q.depth_m = 2;
    q.impulse = {.spherical = 3};
    EXPECT_NEAR(lens_response(q).energy_in_frame, 1, 1e-6);
}

TEST(LensResponse, ZeroWidthDiscsAreOnePixelOrFour) {
    for (const double n : {2.0, infinity}) {
        const LensResponse odd = lens_response({.lens = {50, n}, .size_px = 5});
        EXPECT_NEAR(odd.grid.at(2, 2), 1, 1e-9);
        const LensResponse even = lens_response({.lens = {50, n}, .size_px = 4});
        for (const auto& [i, j] : {std::pair{1, 1}, {2, 1}, {1, 2}, {2, 2}})
            EXPECT_NEAR(even.grid.at(i, j), 0.25, 1e-9);
    }
}

TEST(LensResponse, TendsToTheDiscForShortWaves) {
    const auto distance = [](double wavelength_nm) {
        LensResponseRequest q{.lens = {50, 2}, .depth_m = 2, .wavelength_nm = wavelength_nm, .size_px = 101};
        const LensResponse disc = lens_response(q);
        q.impulse = diffraction;
        const LensResponse wave = lens_response(q);
        double sum = 0;
        for (std::size_t i = 0; i < disc.grid.share.size(); ++i) {
            sum += std::abs(disc.grid.share[i] - wave.grid.share[i]);
        }
        return sum;
    };
    const double visible = distance(550), ultraviolet = distance(137.5);
    EXPECT_LT(visible, 0.1);
    // At a quarter of the wavelength, the light beyond a pixel decreases in proportion, and the width of the
    // edge with the square root. This edge is about one pixel wide.
    EXPECT_GT(visible / ultraviolet, 1.9);
    EXPECT_LT(visible / ultraviolet, 4.1);
}

TEST(LensResponse, WavelengthsAreMixedEvenly) {
    LensResponseRequest q{
        .lens = {50, 11}, .depth_m = 1.02, .pixel_pitch_mm = 0.003, .impulse = diffraction, .size_px = 31};
    q.impulse.wavelengths_nm = {480, 620};
    const LensResponse both = lens_response(q);
    EXPECT_EQ(both.wavelength_nm, 550);
    q.impulse.wavelengths_nm = {480};
    const LensResponse blue = lens_response(q);
    q.impulse.wavelengths_nm = {620};
    const LensResponse red = lens_response(q);
    for (std::size_t i = 0; i < both.grid.share.size(); ++i) {
        EXPECT_NEAR(both.grid.share[i], (blue.grid.share[i] + red.grid.share[i]) / 2, 1e-6 * both.peak_share);
    }
}

TEST(LensResponse, RefusesWhatIsOutOfRange) {
    const auto refused = [](const LensResponseRequest& q, ExitCode code, const std::string& part) {
        expect_refused([&] { (void)lens_response(q); }, code, part);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    refused({.lens = {0, 8}}, ExitCode::wrong_arguments, "focal length");
    refused({.lens = {50, 0}}, ExitCode::wrong_arguments, "f-number");
    refused({.lens = {50, nan}}, ExitCode::wrong_arguments, "f-number");
    refused({.lens = {50, 8}, .focus_distance_m = 0.05}, ExitCode::wrong_arguments, "focus distance");
    refused({.lens = {50, 8}, .depth_m = 0}, ExitCode::wrong_arguments, "depth");
    refused({.lens = {50, 8}, .depth_m = nan}, ExitCode::wrong_arguments, "depth");
    refused({.lens = {50, 8}, .pixel_pitch_mm = 0}, ExitCode::wrong_arguments, "pitch");
    refused({.lens = {50, 8}, .size_px = 20000}, ExitCode::wrong_arguments, "size");
    refused({.lens = {50, 8}, .impulse = diffraction, .wavelength_nm = 1}, ExitCode::wrong_arguments,
            "wavelength");
    refused({.lens = {50, infinity}, .impulse = diffraction}, ExitCode::wrong_arguments, "pinhole");
    // A field of metres that would be sampled at a thousandth of the wavelength.
    refused({.lens = {50, 1e-4}, .pixel_pitch_mm = 10, .impulse = diffraction, .size_px = 16384},
            ExitCode::out_of_memory, "needs");
}

TEST(Crossover, IsWhereTheDiametersAreEqual) {
    const Crossover c = crossover(50, 1, 1.2, 0.005, 550);
    const double V_mm = 50 / 0.95;
    const auto airy_mm = [&](double n) { return 2 * 1.219669891 * 550e-6 * V_mm * n / 50; };
    EXPECT_NEAR(airy_mm(c.over_pixel_f_number), 0.005, 1e-11);
    const ThinLens there{50, c.over_defocus_f_number};
    EXPECT_NEAR(airy_mm(c.over_defocus_f_number), coc_diameter_mm(there, 1, 1.2), 1e-10);
    for (const Crossover::Stop& stop : c.stops) {
        EXPECT_EQ(stop.airy_mm > stop.coc_mm, stop.f_number > c.over_defocus_f_number);
    }
    EXPECT_EQ(crossover(50, 1, 1, 0.005, 550).over_defocus_f_number, 0);
    EXPECT_THROW((void)crossover(50, 0.04, 1, 0.005, 550), Error);
    EXPECT_THROW((void)crossover(50, 1, -1, 0.005, 550), Error);
}

TEST(LensResponse, BladesStandUprightBehindTheFocus) {
    // A triangular aperture with a corner to the right. Behind the focus the response has the same
    // orientation.
    LensResponseRequest q{.lens = {50, 2}, .depth_m = 2, .size_px = 101};
    q.impulse = {.kind = ImpulseKind::polygon, .blades = 3};
    const auto corner_side = [&] {
        const LensResponse r = lens_response(q);
        EXPECT_NEAR(r.energy_in_frame, 1, 1e-9);
        EXPECT_TRUE(r.profile.empty());
        // The corner is at the disc's radius, the opposite side at half of it.
        double right = 0, left = 0;
        for (int j = 0; j < 101; ++j) {
            for (int i = 0; i < 101; ++i) {
                const double x = r.grid.x_begin + i;
                if (r.grid.at(i, j) > 1e-9) {  // above rounding errors
                    right = std::max(right, x);
                    left = std::min(left, x);
                }
            }
        }
        return right > -left;
    };
    EXPECT_TRUE(corner_side());
    q.depth_m = 0.7;
    EXPECT_FALSE(corner_side());
}

}  // namespace
}  // namespace postlens::test::lens_response_test
