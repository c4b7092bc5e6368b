// Computes I(u, v), the intensity near the focus, for many equidistant v at once.
#pragma once

#include <span>

#include "lens/lommel/bessel.h"

namespace postlens {

/// Sets intensity[i] to I(u, v), the intensity at defocus u and radius v = i * grid.step. Terms below 1e-11
/// of the mean are omitted. Results are bit-identical on all machines with the same sine and Bessel
/// functions.
void lommel_row(double u, const BesselGrid& grid, std::span<double> intensity);

}  // namespace postlens
