// Computes the diffraction intensity I(u, v) near the focus, for many equidistant v at once. In optical units
// [born1999, 8.8.1], u is the defocus and v the radius.
#pragma once

#include <span>

#include "lens/lommel/bessel.h"

namespace postlens {

/// Sets intensity[i] to lommel_intensity(u, v), at defocus u and radius v = i * grid.step. It sums a series,
/// and omits terms below 1e-11 of the mean intensity. Results are bit-identical on all machines with the same
/// sine and Bessel functions.
void lommel_row(double u, const BesselGrid& grid, std::span<double> intensity);

}  // namespace postlens
