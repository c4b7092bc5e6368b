// I(u, v) over an equidistant row of v: Lommel's functions for many v at once.
#pragma once

#include <span>

#include "lens/wave/bessel.h"

namespace postlens {

/// Writes I(u, i step) to intensity[i], i = 0, 1, .. The grid must be as long as the row.
/// The series in (v/u) or (u/v) takes about 25 / |1 - v/u| terms and never more than v + O(v^(1/3)), eight v
/// side by side: 200 |u| steps for the whole of a row where v |u| would be expected. Terms below 1e-11 of the
/// response's own mean are left out. The slow form is `lommel_intensity`. The same bits on every machine but
/// for its library's sine and Bessel functions.
void lommel_row(double u, const BesselGrid& grid, std::span<double> intensity);

}  // namespace postlens
