// How far a picture from records is from the truth because records are points: where an edge crosses a cell
// of the quadtree is known to its corners only.
#pragma once

#include <vector>

#include "focus/frame.h"
#include "lens/focus_geometry.h"

namespace postlens {

/// What a circle of confusion divides the squared error of an edge by. One circle averages the errors of the
/// cells in it, which is their number; those along an edge that runs along the cells are alike, and what is
/// averaged then is the way across.
[[nodiscard]] double averaged_by(double coc_diameter_px, bool aligned);

/// What cells that no edge is seen in hide, since all of their corners miss it, adds to the error of those
/// where one is seen: fitted (docs/planner.md).
inline constexpr double floor_unseen = 1.4;

/// By pixel of the picture: the expected squared error (mean of the channels, encoded values) that comes of
/// the size of the quadtrees' cells (edge_cells.h), less what circles of confusion average out. Reads the
/// records of the picture once; same bits for any number of threads.
[[nodiscard]] std::vector<float> record_floor(FocusFrame& frame, const FocusGeometry& geometry);

}  // namespace postlens
