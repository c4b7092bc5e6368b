#include "lens/lommel/lommel_rows.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/multiversion.h"
#include "lens/lommel/lommel.h"

namespace postlens {
namespace {

constexpr std::size_t lanes = 8;
using Lanes = std::array<double, lanes>;

/// Two sums over Bessel functions J_n(v), from which Lommel's intensity is computed, for eight values of the
/// optical radius v. x is v/u or u/v, whichever is smaller, with the defocus u.
/// - `odd` is the sum of (-1)^s x^(1+2s) J_(1+2s)(v) over s = 0, 1, ..
/// - `even` is the sum of (-1)^s x^(2s) J_(2s)(v) over s = 1, 2, ..
struct SeriesLanes {
    Lanes odd{}, even{};
};

/// Sums the terms t_n = x^n J_n(v) with alternating signs: `odd` over odd n, and `even` over even n from 2.
/// j0 and j1 are the values J_0(v) and J_1(v), which give the first terms. Each further term is computed from
/// the two before it:
///
///     t_(n+1) = n c t_n - x^2 t_(n-1)    with c = 2 x / v
///
/// This recurrence is stable for n < v.
POSTLENS_MULTIVERSION
void sum_upwards(const Lanes& v, const Lanes& x, const double* j0, const double* j1, int terms,
                 SeriesLanes& out) {
    Lanes c, x2, before, here, odd, even;
    for (std::size_t l = 0; l < lanes; ++l) {
        c[l] = 2 * x[l] / v[l];
        x2[l] = x[l] * x[l];
        before[l] = j0[l];
        here[l] = x[l] * j1[l];
        odd[l] = here[l];
        even[l] = 0;
    }
    for (int n = 1; n < terms; n += 4) {
        const double n1 = n, n2 = n + 1, n3 = n + 2, n4 = n + 3;
        for (std::size_t l = 0; l < lanes; ++l) {
            const double t2 = n1 * c[l] * here[l] - x2[l] * before[l];
            const double t3 = n2 * c[l] * t2 - x2[l] * here[l];
            const double t4 = n3 * c[l] * t3 - x2[l] * t2;
            const double t5 = n4 * c[l] * t4 - x2[l] * t3;
            even[l] += t4 - t2;
            odd[l] += t5 - t3;
            before[l] = t4;
            here[l] = t5;
        }
    }
    out.odd = odd;
    out.even = even;
}

/// Sums the two series of Bessel functions of SeriesLanes, `odd` and `even`, up to the order `last`. The
/// Bessel functions are computed by downward recurrence (Miller's algorithm), because upward recurrence is
/// unstable for orders above v. During this recurrence, the sums are computed by Horner's rule.
POSTLENS_MULTIVERSION
void sum_downwards(const Lanes& v, const Lanes& x, int last, SeriesLanes& out) {
    Lanes c, x2, above{}, here, norm{}, odd{}, even{};
    for (std::size_t l = 0; l < lanes; ++l) {
        c[l] = 2 / v[l];
        x2[l] = x[l] * x[l];
        here[l] = 1e-250;
    }
    for (int n = last / 2 * 2; n >= 2; n -= 2) {
        const double even_order = n, odd_order = n - 1;
        for (std::size_t l = 0; l < lanes; ++l) {
            norm[l] += 2 * here[l];
            even[l] = here[l] - x2[l] * even[l];
            const double below = even_order * c[l] * here[l] - above[l];  // J_(n-1)
            odd[l] = below - x2[l] * odd[l];
            above[l] = below;
            here[l] = odd_order * c[l] * below - here[l];  // J_(n-2)
        }
    }
    for (std::size_t l = 0; l < lanes; ++l) {
        norm[l] += here[l];
        out.odd[l] = x[l] * odd[l] / norm[l];
        out.even[l] = -x2[l] * even[l] / norm[l];
    }
}

/// Number of terms after which x^n is below 1e-11.
int terms_needed(double x) {
    constexpr double digits = 25.3;  // -ln 1e-11
    return x <= 0 ? 1 : x < 1 ? static_cast<int>(std::min(digits / -std::log(x), 1e9)) + 2 : 1'000'000'000;
}

double intensity_of(double u, double v, double x, double j0, double odd, double even) {
    if (v > u) {
        const double first = x > 0 ? odd / x : 0, second = x > 0 ? even / x : 0;
        return 4 / (v * v) * (first * first + second * second);
    }
    const double V0 = j0 + even, phase = (u + v * v / u) / 2;
    return 4 / (u * u) * (1 + V0 * V0 + odd * odd - 2 * V0 * std::cos(phase) - 2 * odd * std::sin(phase));
}

}  // namespace

void lommel_row(double u, const BesselGrid& grid, std::span<double> intensity) {
    assert(grid.j0.size() >= intensity.size());
    u = std::abs(u);
    const std::size_t count = intensity.size();
    // The fast series below fail or lose precision at some radii. They divide by the optical radius v, so
    // they fail at v = 0. If the defocus u is small, they lose precision for v <= u. At these radii, the
    // slower function lommel_intensity computes the intensity.
    constexpr double tiny_u = 1e-9, small_u = 8;
    std::size_t i = 0;
    while (i < count && (i == 0 || (u < small_u && static_cast<double>(i) * grid.step <= u))) {
        intensity[i] = lommel_intensity(u, static_cast<double>(i) * grid.step);
        ++i;
    }
    for (; i < count; i += lanes) {
        const std::size_t used = std::min(lanes, count - i);
        Lanes v, x, j0, j1;
        double widest = 0;
        for (std::size_t l = 0; l < lanes; ++l) {
            const std::size_t k = i + std::min(l, used - 1);  // spare lanes repeat the last point
            v[l] = grid.step * static_cast<double>(k);
            j0[l] = grid.j0[k];
            j1[l] = grid.j1[k];
            x[l] = std::max(u, tiny_u) > v[l] ? v[l] / u : std::max(u, tiny_u) / v[l];
            widest = std::max(widest, x[l]);
        }
        SeriesLanes sums;
        const int terms = terms_needed(widest);
        if (terms + 4 < 0.9 * v[0]) {
            sum_upwards(v, x, j0.data(), j1.data(), terms, sums);
        } else {
            sum_downwards(v, x, bessel_last_order(v[used - 1]), sums);
        }
        for (std::size_t l = 0; l < used; ++l) {
            intensity[i + l] = intensity_of(u, v[l], x[l], j0[l], sums.odd[l], sums.even[l]);
        }
    }
}

}  // namespace postlens
