#include "lens/lommel/bessel.h"

#include <cmath>

#include "core/threads.h"

namespace postlens {

int bessel_last_order(double v) {
    // Above this order n, the Bessel function J_n(v) is negligible: it falls like the Airy function
    // Ai(2^(1/3) (n - v) / v^(1/3)), and Ai(15) is 5e-19.
    return static_cast<int>(v + 12 * std::cbrt(v)) + 30;
}

std::vector<double> bessel_orders(double v) {
    const int last = bessel_last_order(v);
    std::vector<double> j(static_cast<std::size_t>(last) + 1);
    if (v == 0) {
        j[0] = 1;
        return j;
    }
    // Computes the Bessel functions J_n(v) for v < 1e-3 from two terms of their power series. For tiny v, the
    // recurrence below would overflow.
    if (v < 1e-3) {
        double term = 1;
        for (int n = 0; n <= last; ++n) {
            j[static_cast<std::size_t>(n)] = term * (1 - v * v / 4 / (n + 1));
            term *= v / 2 / (n + 1);
        }
        return j;
    }
    // Computes the Bessel functions J_n(v) from high to low orders n by the recurrence J_{n-1} = (2n/v) J_n -
    // J_{n+1}. It starts with an arbitrary small value, so all results have a common wrong factor.
    double above = 0, here = 1e-250, sum = 0;
    for (int n = last; n >= 0; --n) {
        j[static_cast<std::size_t>(n)] = here;
        if (n % 2 == 0) sum += n == 0 ? here : 2 * here;
        const double below = 2 * n / v * here - above;
        above = here;
        here = below;
    }
    // The common factor of the results is found from the identity J_0 + 2 J_2 + 2 J_4 + .. = 1.
    for (double& value : j) value /= sum;
    return j;
}

BesselGrid::BesselGrid(double grid_step, std::size_t count) : step(grid_step), j0(count), j1(count) {
    parallel_for(
        count,
        [this](std::size_t i) {
            const double v = step * static_cast<double>(i);
            j0[i] = ::j0(v);
            j1[i] = ::j1(v);
        },
        1 << 12);
}

}  // namespace postlens
