#include "lens/lommel/lommel.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lens/lommel/bessel.h"
#include "lens/lommel/quadrature.h"

namespace postlens {
namespace {

constexpr double pi = std::numbers::pi;
/// Below this defocus |u|, Lommel's series for the inside of the geometric disc, that is, for optical radii v
/// < |u|, are not used. They lose precision: the terms of the intensity nearly cancel, and their sum is
/// divided by the small u^2.
constexpr double small_u = 8;

double squared(double x) {
    return x * x;
}

/// Returns Lommel's function U_n or V_n, where n is `first` [born1999, 8.8, eqs. 8 and 16]. It is the sum of
/// (-1)^s ratio^(n + 2 s) J_(n + 2 s)(v) over s = 0, 1, ... `ratio` is u / v for U_n, and v / u for V_n, with
/// the defocus u and the optical radius v. `j` contains the Bessel functions J_0(v), J_1(v), ...
double lommel_sum(const std::vector<double>& j, double ratio, std::size_t first) {
    double sum = 0;
    const std::size_t last = first + (j.size() - 1 - first) / 2 * 2;
    for (std::size_t n = last + 2; n > first; n -= 2) sum = j[n - 2] - ratio * ratio * sum;
    return sum * std::pow(ratio, static_cast<double>(first));
}

/// Returns Q_2s(v), a sum of products of Bessel functions that occurs in Lommel's formulas for the encircled
/// energy [born1999, 8.8, eq. 27]. `two_s` is the index 2 s. `j` contains the Bessel functions J_0(v),
/// J_1(v), ...
double q_function(const std::vector<double>& j, std::size_t two_s) {
    double sum = 0;
    for (std::size_t p = 0; p <= two_s; ++p) {
        const double term = j[p] * j[two_s - p] + j[p + 1] * j[two_s + 1 - p];
        sum += p % 2 == 0 ? term : -term;
    }
    return sum;
}

/// Returns the sum of (-1)^s / (2 s + 1) ratio^(2 s) Q_2s(v) over s = 0, 1, ..., which occurs in Lommel's
/// formulas for the encircled energy [born1999, 8.8, eqs. 29 and 30]. `ratio` is u/v or v/u. `j` contains the
/// Bessel functions J_0(v), J_1(v), ..., from which q_function computes Q_2s(v).
double q_sum(const std::vector<double>& j, double ratio) {
    double sum = 0, power = 1;
    for (std::size_t s = 0; 2 * s + 2 < j.size() && power > 1e-18; ++s) {
        const double term = power / static_cast<double>(2 * s + 1) * q_function(j, 2 * s);
        sum += s % 2 == 0 ? term : -term;
        power *= ratio * ratio;
    }
    return sum;
}

}  // namespace

double intensity_by_quadrature(double u, double v) {
    u = std::abs(u);
    v = std::abs(v);
    // Integrates J0(v p) exp(-i u p^2 / 2) p over the radius p in the pupil, from 0 to 1. The phase changes
    // by at most u + v radians per unit of p, and therefore by at most pi in each panel. For such a panel, 16
    // quadrature nodes suffice.
    const auto panels = static_cast<int>((u + v) / pi) + 1;
    double re = 0, im = 0;
    for (int i = 0; i < panels; ++i) {
        const double width = 1.0 / panels;
        for (const GaussNode& node : gauss_legendre_16()) {
            const double p = (i + node.x) * width;
            const double weight = 2 * node.weight * width * p * ::j0(v * p);
            re += weight * std::cos(u * p * p / 2);
            im -= weight * std::sin(u * p * p / 2);
        }
    }
    return re * re + im * im;
}

double lommel_intensity(double u, double v) {
    u = std::abs(u);
    v = std::abs(v);
    if (v <= u && u < small_u) return intensity_by_quadrature(u, v);
    if (v == 0) return squared(std::sin(u / 4) / (u / 4));
    const std::vector<double> j = bessel_orders(v);
    if (v > u) {
        // At the defocus u and the radius v, the intensity is (2/u)^2 (U1^2 + U2^2), with the Lommel
        // functions U1 and U2 [born1999, 8.8]. `odd` is U1 divided by x = u / v, and `even` is U2 divided by
        // x^2. Then u cancels in the intensity, so that u may be 0.
        const double x = u / v;
        double odd = 0, even = 0;
        for (std::size_t n = j.size() - 1; n >= 1; --n) {
            double& sum = n % 2 == 1 ? odd : even;
            sum = j[n] - x * x * sum;
        }
        return squared(2 / v) * (squared(odd) + squared(x * even));
    }
    const double V0 = lommel_sum(j, v / u, 0), V1 = lommel_sum(j, v / u, 1);
    const double phase = (u + v * v / u) / 2;
    return squared(2 / u) *
           (1 + V0 * V0 + V1 * V1 - 2 * V0 * std::cos(phase) - 2 * V1 * std::sin(phase));  // [eq. 19]
}

double lommel_encircled_energy(double u, double v) {
    u = std::abs(u);
    v = std::abs(v);
    if (v == 0) return 0;
    const std::vector<double> j = bessel_orders(v);
    if (v > u || u < small_u) return 1 - q_sum(j, u / v);  // [born1999, 8.8, eq. 30]
    // Computes the fraction of the light within the radius v, at a defocus u >= v [born1999, 8.8, eq. 29]. Y1
    // and Y2 are two series of this equation. Y1 sums the terms that contain Bessel functions of odd order,
    // and Y2 those of even order.
    const double x = v / u;
    double Y1 = 0, Y2 = 0, power = x;
    for (std::size_t n = 1; n < j.size() && power > 1e-18; ++n) {
        const double term = static_cast<double>(n) * power * j[n];
        double& sum = n % 2 == 1 ? Y1 : Y2;
        sum += (n - 1) / 2 % 2 == 0 ? term : -term;
        power *= x;
    }
    const double phase = (u + v * v / u) / 2;
    return x * x * (1 + q_sum(j, x)) - 4 / u * (Y1 * std::cos(phase) + Y2 * std::sin(phase));
}

double energy_beyond(double u, double v) {
    return 2 / pi * v / (v * v - u * u);
}

}  // namespace postlens
