// I(u, v), the intensity near the focus, for an equidistant row of v: Lommel's functions for many v at once.
#pragma once

#include <span>

#include "lens/lommel/bessel.h"

namespace postlens {

/// Writes I(u, i step) to intensity[i], i = 0, 1, .. The grid must be at least as long as the row. Eight
/// values of v are computed at once, by a series in (v/u) or (u/v). The series needs about 25 / |1 - v/u|
/// terms, at most v + O(v^(1/3)). A whole row thus needs about 200 |u| steps instead of v |u|. Terms below
/// 1e-11 of the response's mean are omitted. The slow reference is `lommel_intensity`. Results are
/// bit-identical on machines whose libraries have the same sine and Bessel functions.
void lommel_row(double u, const BesselGrid& grid, std::span<double> intensity);

}  // namespace postlens
