// I(u, v) for an equidistant row of v: Lommel's functions for many v at once.
#pragma once

#include <span>

#include "lens/lommel/bessel.h"

namespace postlens {

/// Writes I(u, i step) to intensity[i], i = 0, 1, .. The grid must be as long as the row.
/// The series in (v/u) or (u/v) takes about 25 / |1 - v/u| terms, at most v + O(v^(1/3)), for eight v at
/// once. A whole row takes about 200 |u| steps instead of v |u|. Terms below 1e-11 of the mean of the
/// response are left out. The slow form is `lommel_intensity`. Results are bit-identical on machines whose
/// libraries have the same sine and Bessel functions.
void lommel_row(double u, const BesselGrid& grid, std::span<double> intensity);

}  // namespace postlens
