// Bessel functions of the first kind and integer order.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

/// Returns the Bessel functions J_0(v), J_1(v), .. for v >= 0 [abramowitz1972, 9.12]. Errors are about 1e-15
/// of the largest, and the last values are below 1e-18. Needs v + O(v^(1/3)) steps.
[[nodiscard]] std::vector<double> bessel_orders(double v);

/// Returns an order n at which the Bessel function J_n(v) is below 1e-18. The recurrence of bessel_orders
/// starts there.
[[nodiscard]] int bessel_last_order(double v);

/// Tables of the Bessel functions J_0(v) and J_1(v). Element i of a table is the value at v = i * step.
/// Functions of higher orders need no tables, because upward recurrences compute them from these two.
struct BesselGrid {
    double step = 0.5;
    std::vector<double> j0, j1;

    BesselGrid() = default;
    BesselGrid(double grid_step, std::size_t count);
};

}  // namespace postlens
