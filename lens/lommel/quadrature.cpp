#include "lens/lommel/quadrature.h"

#include <cmath>
#include <numbers>

namespace postlens {
namespace {

std::array<GaussNode, 16> make_nodes() {
    constexpr int n = 16;
    std::array<GaussNode, n> nodes;
    for (int i = 0; i < n; ++i) {
        // Estimates the i-th root of the Legendre polynomial [abramowitz1972, 22.16.6], from which Newton's
        // method converges.
        double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
        double slope = 0;
        for (int step = 0; step < 6; ++step) {
            double p = 1, before = 0;
            for (int k = 1; k <= n; ++k) {
                const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
                before = p;
                p = next;
            }
            slope = n * (before - x * p) / (1 - x * x);
            x -= p / slope;
        }
        nodes[static_cast<std::size_t>(n - 1 - i)] = {(1 + x) / 2, 1 / ((1 - x * x) * slope * slope)};
    }
    return nodes;
}

}  // namespace

const std::array<GaussNode, 16>& gauss_legendre_16() {
    static const std::array<GaussNode, 16> nodes = make_nodes();
    return nodes;
}

}  // namespace postlens
