// Lommel's functions and the tables made from them: closed forms, quadrature, energy.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <vector>

#include "lens/lommel/bessel.h"
#include "lens/lommel/lommel.h"
#include "lens/lommel/lommel_rows.h"
#include "lens/lommel/radial_energy.h"

namespace postlens::test::diffraction_test {
namespace {

constexpr double pi = std::numbers::pi;

TEST(Bessel, OrdersAgreeWithTheLibrary) {
    for (const double v : {0.0, 1e-5, 1e-3, 0.3, 1.0, 7.5, 40.0, 399.0, 4211.0}) {
        const std::vector<double> j = bessel_orders(v);
        // Rounding of the recurrence and of the argument's phase is a few times v 2^-53.
        const double tolerance = 1e-15 * (4 + v);
        EXPECT_NEAR(j[0], ::j0(v), tolerance) << v;
        EXPECT_NEAR(j[1], ::j1(v), tolerance) << v;
        EXPECT_NEAR(j[20], ::jn(20, v), tolerance) << v;
        EXPECT_LT(std::abs(j.back()), 1e-18) << v;
    }
}

TEST(Diffraction, InFocusIsAiry) {
    EXPECT_NEAR(lommel_intensity(0, 0), 1, 1e-15);
    for (double v = 0.05; v < 200; v += 0.37) {
        const double airy = 2 * ::j1(v) / v;
        EXPECT_NEAR(lommel_intensity(0, v), airy * airy, 1e-14) << v;
    }
    // The first zero is 3.8317059702 = 1.2196699 pi.
    EXPECT_LT(lommel_intensity(0, 3.8317059702), 1e-20);
    EXPECT_GT(lommel_intensity(0, 3.83), 1e-7);
}

TEST(Diffraction, OnAxisIsTheSquaredSincOfAQuarterOfU) {
    for (double u = 0.01; u < 6000; u *= 1.173) {
        const double sinc = std::sin(u / 4) / (u / 4);
        // Both the quadrature (u < 8) and the closed form (u >= 8) are accurate to about 1e-15 of the peak in
        // focus.
        EXPECT_NEAR(lommel_intensity(u, 0), sinc * sinc, 4e-15) << u;
    }
    // The first dark point on the axis is at u = 4 pi.
    EXPECT_LT(lommel_intensity(4 * pi, 0), 1e-30);
}

TEST(Diffraction, IsTheSameOnBothSidesOfTheFocus) {
    for (const double u : {0.5, 7.0, 90.0}) {
        for (const double v : {0.0, 3.0, 7.0, 100.0}) {
            EXPECT_EQ(lommel_intensity(-u, v), lommel_intensity(u, v));
            EXPECT_EQ(lommel_intensity(u, -v), lommel_intensity(u, v));
        }
    }
}

// The largest difference from direct quadrature over a dense row of v, on both sides of the edge and at it,
// relative to the response's own peak (the peak is at most 1, in focus, and 3e-7 at u = 4211).
double worst_of_row(double u, int points) {
    double worst = 0, peak = 0;
    const auto take = [&](double v) {
        const double exact = intensity_by_quadrature(u, v);
        peak = std::max(peak, exact);
        worst = std::max(worst, std::abs(lommel_intensity(u, v) - exact));
    };
    for (int i = 0; i <= points; ++i) take((2 * u + 40) * i / points);
    for (const double near_edge : {-1e-3, -1e-9, 0.0, 1e-9, 1e-3}) take(std::abs(u + near_edge));
    for (double away = -3; away <= 3; away += 0.25) take(std::abs(u + away));
    return worst / peak;
}

TEST(Diffraction, AgreesWithQuadratureUpToU400) {
    // Both methods sum about u + v terms of size 1 with phase errors of (u + v) 2^-53, which makes 1e-13. The
    // required accuracy is only 1e-6 of the peak in focus.
    for (const double u : {0.0, 1e-12, 1e-6, 0.01, 0.7, 3.0, 7.99, 8.0, 8.01, 12.0, 4 * pi, 25.0, 63.0, 100.0,
                           170.0, 251.3, 333.0, 399.0, 400.0}) {
        EXPECT_LT(worst_of_row(u, 300), 1e-12) << u;
    }
}

TEST(Diffraction, AgreesWithQuadratureUpToU5000) {
    // An 85 mm f/1.4 lens at its nearest distance reaches u = 4211. The error is the rounding of the phase,
    // relative to a mean intensity of 4 / u^2.
    for (const double u : {1000.0, 2345.6, 4211.0, 5000.0}) EXPECT_LT(worst_of_row(u, 24), 1e-11) << u;
}

TEST(Diffraction, RowsAgreeWithPoints) {
    for (const double u :
         {0.0, 1e-12, 1e-6, 0.4, 7.9, 8.0, 31.0, 100.0, 255.9, 256.0, 400.0, 1777.0, 5000.0}) {
        const double step = RadialEnergy::step_for(u);
        const BesselGrid grid(step, static_cast<std::size_t>((1.3 * u + 100) / step));
        std::vector<double> row(grid.j0.size());
        lommel_row(-u, grid, row);
        // Tests all points near the edge, and every `stride`-th point elsewhere.
        const std::size_t stride = 1 + row.size() / 700;
        double worst = 0, peak = 0;
        for (std::size_t i = 0; i < row.size(); ++i) {
            const double v = step * static_cast<double>(i);
            if (i % stride != 0 && std::abs(v - u) > 12) continue;
            const double exact = lommel_intensity(u, v);
            peak = std::max(peak, exact);
            worst = std::max(worst, std::abs(row[i] - exact));
        }
        // Series end when terms are below 1e-11 of the mean, which is at most a quarter of the peak.
        EXPECT_LT(worst / peak, 1e-11) << u;
    }
}

TEST(EncircledEnergy, InFocusIsRayleighs) {
    for (const double v : {0.01, 1.0, 3.8317, 20.0, 300.0}) {
        const double j0 = ::j0(v), j1 = ::j1(v);
        EXPECT_NEAR(lommel_encircled_energy(0, v), 1 - j0 * j0 - j1 * j1, 1e-14) << v;
    }
}

TEST(EncircledEnergy, ClosedFormIsTheIntegralOfTheIntensity) {
    // Compares central differences of the closed form with I v / 2. Their error is h^2/6 times a third
    // derivative of at most 4 times the slope, plus rounding of 1e-13 / h.
    constexpr double h = 1e-3;
    for (const double u : {0.0, 1.0, 7.9, 8.1, 30.0, 200.0}) {
        for (const double v : {0.5, 3.0, 8.0, 29.0, 30.5, 50.0, 190.0, 210.0}) {
            const double slope =
                (lommel_encircled_energy(u, v + h) - lommel_encircled_energy(u, v - h)) / (2 * h);
            EXPECT_NEAR(slope, lommel_intensity(u, v) * v / 2, 1e-6) << u << " " << v;
        }
    }
}

TEST(EncircledEnergy, TableIsTheClosedForm) {
    for (const double u : {0.0, 0.3, 7.9, 8.0, 20.0, 100.0, 255.0, 257.0, 400.0}) {
        const RadialEnergy table(-u, 1.2 * u + 60);
        for (int i = 0; i <= 60; ++i) {
            const double v = table.v_end() * i / 60;
            // Cubic interpolation of fringes with a frequency of at most 2 has an error of (2 h)^4 / 384 of
            // their amplitude: 1e-5 of less than 0.04 at h = 1/8, 2.6e-3 of 1/u at h = 1/2.
            EXPECT_NEAR(table.within(v), lommel_encircled_energy(u, v), u < 256 ? 4e-7 : 1e-5)
                << u << " " << v;
        }
    }
}

TEST(EncircledEnergy, WithTheAnalyticTailIsOne) {
    for (double u = 0; u <= 5000; u = u * 1.31 + 0.7) {
        // The mean energy of the tail omits fringes of 1 / (pi v^2), 5e-5 at a distance of 80 from the edge.
        const double v_end = u + std::max(80.0, 8 * std::sqrt(u));
        const RadialEnergy table(u, v_end);
        EXPECT_NEAR(table.within(table.v_end()) + energy_beyond(u, table.v_end()), 1, 1e-4) << u;
    }
}

TEST(EncircledEnergy, TendsToTheGeometricDisc) {
    // The energy within a disc is (v/u)^2, and fringes of the edge hold 1/sqrt(u) of the energy. Halving the
    // wavelength doubles u and v, so the difference from the disc decreases.
    const auto from_disc = [](double u) {
        const RadialEnergy table(u, 1.5 * u);
        double worst = 0;
        for (double x = 0; x < 1.5; x += 0.01) {
            worst = std::max(worst, std::abs(table.within(x * u) - std::min(x * x, 1.0)));
        }
        return worst;
    };
    EXPECT_LT(from_disc(400), 0.05);
    EXPECT_LT(from_disc(4000), 0.016);
    EXPECT_GT(from_disc(400), 2 * from_disc(4000));
}

TEST(EncircledEnergy, IntegralGivesMeans) {
    for (const double u : {5.0, 700.0}) {
        const RadialEnergy table(u, 1.1 * u + 30);
        for (const double v0 : {0.0, 0.6 * u, u}) {
            const double width = 20;
            double sum = 0;
            constexpr int steps = 4000;
            for (int i = 0; i < steps; ++i) sum += table.within(v0 + (i + 0.5) * width / steps);
            // Error of the midpoint rule: (width/steps)^2/24 times a second derivative of at most 1.
            EXPECT_NEAR((table.within_integral(v0 + width) - table.within_integral(v0)) / width, sum / steps,
                        2e-6)
                << u << " " << v0;
        }
    }
}

}  // namespace
}  // namespace postlens::test::diffraction_test
