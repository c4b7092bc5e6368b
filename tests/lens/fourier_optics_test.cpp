// Fourier optics against closed forms: a disc, a square, aberrations.
#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/threads.h"
#include "lens/lommel/lommel.h"
#include "lens/lommel/pixel_energy.h"
#include "lens/wave/fourier_response.h"

namespace postlens::test::fourier_optics_test {
namespace {

constexpr double pi = std::numbers::pi;

ResponseGrid window(int half) {
    return {-half, -half, 2 * half + 1, 2 * half + 1};
}

double peak_of(const ResponseGrid& grid) {
    return *std::max_element(grid.share.begin(), grid.share.end());
}

double intensity_on_axis(const FourierResponse& r) {
    return fourier_field(r, fourier_sampling(r, window(8))).intensity[0];
}

// Tolerance of a field's amplitude against the closed form, for `cells` = a. First term, four sigma: the
// outline crosses about 8 a cells of area 1/a^2 (of pi in all), and 16 x 16 points give the coverage of a
// cell with an RMS error of 1/16 / sqrt(12) / 4 = 0.0045. Second term, aliasing: the edge wave at 2 pi a - v
// is added with the factor v / (2 pi a), which division by the cell's transform leaves, on two axes.
double field_tolerance(double u, double v, double cells) {
    const double outline = 4 * 0.0045 * std::sqrt(8 * cells) / (pi * cells * cells);
    const double far = 2 * pi * cells - v, edge = std::min(u / far, 0.9);
    const double alias = 2 / far * std::sqrt(2 / (pi * far)) / (1 - edge * edge) * v / (2 * pi * cells);
    return outline + 2 * alias;
}

TEST(FourierOptics, DiscIsLommels) {
    for (const double u : {0.0, 5.0, -30.0, 100.0, 333.0}) {
        const FourierResponse r{.u = u, .v_per_px = 4};
        const FourierSampling s = fourier_sampling(r, window(20));
        const FourierField field = fourier_field(r, s);
        const auto size = static_cast<std::size_t>(s.size);
        EXPECT_NEAR(field.light, pi, 4 * 0.0045 * std::sqrt(8 * s.cells) / (s.cells * s.cells));
        for (int k = 0; k * s.v_step < std::abs(u) + 40; ++k) {
            const double v = k * s.v_step, exact = lommel_intensity(u, v);
            const double amplitude = field_tolerance(std::abs(u), v, s.cells);
            const double tolerance = 2 * std::sqrt(exact) * amplitude + amplitude * amplitude;
            const auto i = static_cast<std::size_t>(k);
            EXPECT_NEAR(field.intensity[i], exact, tolerance) << u << " " << v;
            EXPECT_NEAR(field.intensity[i * size], exact, tolerance) << u << " " << v;
            EXPECT_NEAR(field.intensity[(size - i) % size], exact, tolerance) << u << " " << -v;
        }
    }
}

TEST(FourierOptics, PixelsOfTheDiscAreThoseOfTheEncircledEnergy) {
    struct Case {
        double u, v_per_px;
    };
    for (const auto& [u, v_per_px] :
         {Case{0, 0.7}, Case{0, 4}, Case{12, 0.9}, Case{30, 4}, Case{100, 30}, Case{250, 20}}) {
        ResponseGrid grid = window(static_cast<int>(u / v_per_px) + 6);
        const FourierResponse r{.u = u, .v_per_px = v_per_px, .centre_x = 0.3, .centre_y = 0.7};
        fill_fourier_energy(r, grid);
        ResponseGrid exact = grid;
        const RadialEnergy energy(u, reach_px(grid, 0.3, 0.7, {}) * v_per_px);
        fill_pixel_energy(RadialProfile({{&energy, v_per_px, 1.0}}), 0.3, 0.7, {}, exact);
        // In the worst case all samples of a pixel have the same error, which makes 2 dA sqrt(I). The pixels
        // from the encircled energy have an error of 5e-4.
        const double cells = fourier_sampling(r, grid).cells;
        const double mean_intensity = peak_of(exact) * 4 * pi / (v_per_px * v_per_px);
        const double tolerance = 2 * field_tolerance(u, u, cells) / std::sqrt(mean_intensity) + 5e-4;
        ASSERT_LT(tolerance, 0.02);
        for (std::size_t i = 0; i < grid.share.size(); ++i) {
            ASSERT_NEAR(grid.share[i], exact.share[i], tolerance * peak_of(exact))
                << u << " " << v_per_px << " " << i;
        }
    }
}

TEST(FourierOptics, SquareIsTheProductOfTwoSincs) {
    constexpr double h = 0.6;
    FourierResponse r{.transmission = polygon_aperture({{-h, -h}, {h, -h}, {h, h}, {-h, h}}),
                      .v_per_px = 1.7};
    const FourierSampling s = fourier_sampling(r, window(10));
    const FourierField field = fourier_field(r, s);
    const auto sinc = [](double x) { return x == 0 ? 1 : std::sin(x) / x; };
    for (std::size_t j = 0; j < 20; ++j) {
        for (std::size_t i = 0; i < 20; ++i) {
            const double x = h * s.v_step * static_cast<double>(i), y = h * s.v_step * static_cast<double>(j);
            const double amplitude = 4 * h * h / pi * sinc(x) * sinc(y);
            // The sides are parallel to the cells, so all cells of a side have the same error: up to half a
            // row of points, which is 1/16 of a cell.
            const double side = 4 * 2 * h / (32 * s.cells) / pi;
            EXPECT_NEAR(field.intensity[j * static_cast<std::size_t>(s.size) + i], amplitude * amplitude,
                        2 * std::abs(amplitude) * side + side * side);
        }
    }
}

TEST(FourierOptics, PictureOfADiscIsNearlyADisc) {
    constexpr int n = 256;
    constexpr double half = n / 2.0;
    std::vector<float> values;
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i)
            values.push_back(std::hypot(i + 0.5 - half, j + 0.5 - half) < half ? 1.0F : 0.0F);
    }
    FourierResponse r{.transmission = picture_aperture(n, n, values), .u = 10, .v_per_px = 3};
    ResponseGrid grid = window(8), exact = window(8);
    fill_fourier_energy(r, grid);
    r.transmission = circular_aperture();
    fill_fourier_energy(r, exact);
    // The error of the outline is a fraction of a pixel, with 128 pixels per radius, and much less on
    // average.
    for (std::size_t i = 0; i < grid.share.size(); ++i) {
        EXPECT_NEAR(grid.share[i], exact.share[i], 2.0 / 128 * peak_of(exact));
    }
}

TEST(FourierOptics, BehindTheFocusTheApertureStandsUpright) {
    // The aperture is half a disc, x > 0. A lens point q displaces points behind the focus by +q on the
    // raster.
    const auto right = [](double x, double y) { return x > 0 && x * x + y * y < 1 ? 1.0 : 0.0; };
    for (const double u : {60.0, -60.0}) {
        ResponseGrid grid(-20, -20, 40, 40);
        fill_fourier_energy({.transmission = right, .u = u, .v_per_px = 5}, grid);
        double on_right = 0, all = 0;
        for (int j = 0; j < 40; ++j) {
            for (int i = 0; i < 40; ++i) {
                all += grid.at(i, j);
                if (i >= 20) on_right += grid.at(i, j);
            }
        }
        // Diffraction spreads light across the straight edge, about 1 / sqrt(u) of it.
        EXPECT_NEAR(on_right / all, u > 0 ? 1 : 0, 1 / std::sqrt(60.0));
    }
}

TEST(Wavefront, ZernikePolynomialsAreOrthonormal) {
    const std::vector<std::pair<int, int>> terms = {{0, 0}, {1, 1},  {1, -1}, {2, 0},
                                                    {2, 2}, {3, -1}, {4, 0},  {6, 2}};
    for (const auto& [n, m] : terms) {
        for (const auto& [k, l] : terms) {
            double sum = 0;
            constexpr int radii = 200, angles = 32;
            for (int i = 0; i < radii; ++i) {
                const double p = std::sqrt((i + 0.5) / radii);  // rings of equal area
                for (int a = 0; a < angles; ++a) {
                    const double t = 2 * pi * a / angles;
                    sum += zernike_polynomial(n, m, p * std::cos(t), p * std::sin(t)) *
                           zernike_polynomial(k, l, p * std::cos(t), p * std::sin(t));
                }
            }
            // Error of the midpoint rule over p^2: products of degree 6 in p^2 have second derivatives of up
            // to 1e3.
            EXPECT_NEAR(sum / (radii * angles), n == k && m == l ? 1 : 0, 3e-3) << n << m << k << l;
        }
    }
}

TEST(Wavefront, DefocusByAnyNameIsU) {
    // The intensity on the axis is (sin(u/4) / (u/4))^2. W = u p^2 / (4 pi), and Z_2^0 = sqrt(3) (2 p^2 - 1).
    for (const double u : {2.0, 9.0, 30.0}) {
        const double exact = lommel_intensity(u, 0);
        const double tolerance = 2 * std::sqrt(exact) * field_tolerance(u, 0, 96);
        EXPECT_NEAR(intensity_on_axis({.u = u}), exact, tolerance);
        EXPECT_NEAR(intensity_on_axis({.wavefront = {.field_curvature = u / (4 * pi)}}), exact, tolerance);
        const double rms = u / (8 * pi * std::sqrt(3));
        EXPECT_NEAR(intensity_on_axis({.wavefront = {.zernike = {{2, 0, rms}}}}), exact, tolerance);
        // Field curvature and defocus of opposite sign cancel.
        EXPECT_NEAR(intensity_on_axis({.wavefront = {.field_curvature = u / (4 * pi)}, .u = -u}), 1, 1e-4);
    }
}

TEST(Wavefront, StrehlIsMarechals) {
    // The Strehl ratio is exp(-(2 pi W)^2) for an error of W waves RMS, up to third order; the third moment
    // of the phase is at most 3.
    for (const ZernikeTerm term :
         {ZernikeTerm{4, 0, 0.04}, {3, 1, 0.04}, {3, -1, 0.04}, {2, 2, 0.04}, {2, -2, 0.04}, {6, 0, 0.04}}) {
        const double sigma = 2 * pi * term.waves_rms;
        EXPECT_NEAR(intensity_on_axis({.wavefront = {.zernike = {term}}}), std::exp(-sigma * sigma),
                    sigma * sigma * sigma / 3)
            << term.n << " " << term.m;
    }
}

TEST(Wavefront, DistortionMovesThePicture) {
    // A wavefront W = w x displaces the image to v = 2 pi w.
    ResponseGrid still = window(10), moved = window(10);
    const double v_per_px = 2 * pi;
    fill_fourier_energy({.v_per_px = v_per_px, .centre_x = 0.5, .centre_y = 0.5}, still);
    fill_fourier_energy(
        {.wavefront = {.distortion = 3}, .v_per_px = v_per_px, .centre_x = 0.5, .centre_y = 0.5}, moved);
    for (int j = 0; j < 21; ++j) {
        for (int i = 3; i < 21; ++i) EXPECT_NEAR(moved.at(i, j), still.at(i - 3, j), 1e-4 * peak_of(still));
    }
}

TEST(FourierOptics, SameBitsForAnyNumberOfThreads) {
    const auto run = [](int threads) {
        const ThreadLimit limit(threads);
        ResponseGrid grid = window(9);
        fill_fourier_energy({.wavefront = {.coma = 1.5}, .u = 20, .v_per_px = 3}, grid);
        return grid.share;
    };
    EXPECT_EQ(run(1), run(4));
}

TEST(FourierOptics, RefusesWhatItCannotMake) {
    const auto refused = [](const std::function<void()>& make, ExitCode code, const std::string& part) {
        try {
            make();
            ADD_FAILURE() << part;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), code) << e.what();
            EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
        }
    };
    ResponseGrid grid = window(4);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    // A phase that is too steep for any grid in memory is rejected instead of aliased.
    refused([&] { fill_fourier_energy({.u = 9e5, .v_per_px = 1}, grid); }, ExitCode::out_of_memory, "needs");
    refused([&] { fill_fourier_energy({.wavefront = {.spherical = 9999}}, grid); }, ExitCode::out_of_memory,
            "needs");
    refused([&] { fill_fourier_energy({.u = nan}, grid); }, ExitCode::wrong_arguments, "out of range");
    refused([&] { fill_fourier_energy({.v_per_px = 0}, grid); }, ExitCode::wrong_arguments, "out of range");
    refused([&] { fill_fourier_energy({.wavefront = {.coma = nan}}, grid); }, ExitCode::wrong_arguments,
            "aberration");
    refused(
        [&] {
            fill_fourier_energy({.wavefront = {.zernike = {{3, 2, 0.1}}}}, grid);
        },
        ExitCode::wrong_arguments, "Zernike");
    refused([&] { fill_fourier_energy({.transmission = [](double, double) { return 0.0; }}, grid); },
            ExitCode::wrong_arguments, "no light");
    refused([] { (void)polygon_aperture({{0, 0}, {1, 0}}); }, ExitCode::wrong_arguments, "corners");
    refused([] { (void)polygon_aperture({{0, 0}, {1, 0}, {0, 2}}); }, ExitCode::wrong_arguments, "corner");
    refused([] { (void)picture_aperture(2, 1, {0.5F, 1.5F}); }, ExitCode::wrong_arguments, "transmission");
    refused([] { (void)picture_aperture(2, 1, {0, 0}); }, ExitCode::wrong_arguments, "no light");
    refused([] { (void)picture_aperture(2, 2, {1, 1}); }, ExitCode::wrong_arguments, "no pixels");
}

}  // namespace
}  // namespace postlens::test::fourier_optics_test
