// Gauss-Legendre quadrature on [0, 1].
#pragma once

#include <array>

namespace postlens {

struct GaussNode {
    double x = 0;       ///< in (0, 1)
    double weight = 0;  ///< weights of all nodes add up to 1
};

/// Returns the 16 nodes and weights, which integrate polynomials up to degree 31 exactly.
[[nodiscard]] const std::array<GaussNode, 16>& gauss_legendre_16();

}  // namespace postlens
