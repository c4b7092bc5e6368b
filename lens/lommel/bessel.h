// Bessel functions of the first kind and integer order.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

/// Returns J_0(v), J_1(v), .. for v >= 0, up to an order at which the values are below 1e-18 of the largest
/// value. Uses the downward recurrence J_{n-1} = (2n/v) J_n - J_{n+1}, normalised by J_0 + 2 J_2 + 2 J_4 + ..
/// = 1 [abramowitz1972, 9.12]. The error of each value is about 1e-15 of the largest. Needs v + O(v^(1/3))
/// steps.
[[nodiscard]] std::vector<double> bessel_orders(double v);

/// Returns an order n above v at which the Bessel function J_n(v) is below 1e-18. The downward recurrence of
/// bessel_orders starts there.
[[nodiscard]] int bessel_last_order(double v);

/// Tables of the Bessel functions J_0(v) and J_1(v) at v = 0, step, 2 step, ... For all depths and
/// wavelengths, higher orders are computed from these values by upward recurrences.
struct BesselGrid {
    double step = 0.5;
    std::vector<double> j0, j1;

    BesselGrid() = default;
    BesselGrid(double grid_step, std::size_t count);
};

}  // namespace postlens
