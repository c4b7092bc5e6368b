// Converts an image with motion vectors to sheets. A sheet is a connected part of a surface, of which each
// pixel has a colour and a velocity in the image. From sheets, images of other instants can be made.
#pragma once

#include "motionblur/vectors/vector_frame.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// Object ids of the sheets that `vector_sheets` creates.
inline constexpr std::uint32_t still_id = 0, moving_id = 1;

/// Converts an image with motion vectors to sheets, which are connected surfaces within squares of the
/// raster. Every pixel becomes a cell with one colour and one depth, so static pixels keep their exact
/// values. Where the file stores no pixel, cells are black, static and infinitely far away.
///
/// At a corner shared by pixels of one surface, their vectors are averaged. This prevents cracks in a surface
/// that rotates or grows.
///
/// The velocity v of a cell, in px per frame, is stored as the matrix W = (-v.x 0; -v.y 0), which reprojects
/// it. The first coordinate of the lens point (LensShift::lens_px) stands for time in frames. Throws
/// Error(out_of_memory).
[[nodiscard]] SheetMesh vector_sheets(const VectorFrame& frame);

/// Returns whether two neighbouring pixels seem to belong to one surface, by motion vectors, ids and depths
/// (if `has_z`).
[[nodiscard]] bool one_surface(const VectorPixel& a, const VectorPixel& b, bool has_z);

}  // namespace postlens
