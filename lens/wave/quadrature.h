// Gauss-Legendre quadrature on [0, 1].
#pragma once

#include <array>

namespace postlens {

struct GaussNode {
    double x = 0;       ///< in (0, 1)
    double weight = 0;  ///< all together 1
};

/// The 16 nodes that are exact for polynomials of degree 31, by Newton's method on Legendre's polynomial.
[[nodiscard]] const std::array<GaussNode, 16>& gauss_legendre_16();

}  // namespace postlens
