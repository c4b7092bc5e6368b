// The closed form of a step edge that is blurred by a disc.
#pragma once

#include <cmath>
#include <numbers>

namespace postlens::test {

/// The response of a step edge that is blurred by a disc of radius 1, at the signed distance t from the edge.
inline double edge_response(double t) {
    if (t <= -1) return 0;
    if (t >= 1) return 1;
    return 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / std::numbers::pi;
}

}  // namespace postlens::test
