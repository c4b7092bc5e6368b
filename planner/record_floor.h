// How far a picture from records is from the truth because records are points: where an edge crosses a cell
// of the quadtree is known to its corners only.
#pragma once

#include <vector>

#include "focus/frame.h"
#include "lens/focus_geometry.h"

namespace postlens {

/// Mean squared error of the share that a straight edge of any direction and place, which parts the corners
/// of a square, takes of it, when the share is taken to be that of the corners: 200,000 random edges give
/// 0.0388.
inline constexpr double edge_cell_variance = 0.0388;

/// By pixel of the picture: the expected squared error (mean of the channels, encoded values) that comes of
/// the size of the quadtrees' cells. A cell that was subdivided, whose corners show different ids or
/// differ by a tenth or more, is taken to hold an edge as high as its corners differ; others to be smooth, with the error that half
/// their curvature has. A circle of confusion wider than a pixel averages over its area. Reads the records of
/// the picture once; same bits for any number of threads.
[[nodiscard]] std::vector<float> record_floor(FocusFrame& frame, const FocusGeometry& geometry);

}  // namespace postlens
