// Converts an image with motion vectors to sheets: connected surfaces with a velocity per pixel.
#pragma once

#include "motionblur/vectors/vector_frame.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// Object ids of the sheets that `vector_sheets` creates.
inline constexpr std::uint32_t still_id = 0, moving_id = 1;

/// Converts an image with motion vectors to sheets, which are connected surfaces within squares of the
/// raster. A pixel is the mean over its square, so every pixel becomes a cell with one colour and one depth.
/// Static pixels therefore keep their exact values. The sample positions of the views are distributed over
/// the pixel, so moving edges are antialiased correctly.
///
/// At a corner shared by several pixels, those that belong to one surface get the mean of their vectors. This
/// prevents cracks in a surface that rotates or grows. Different surfaces may separate. Pixels of the display
/// window that the file does not store are black, static and infinitely far away.
///
/// The velocity v of a cell, in px per frame to the right and down, is stored as the matrix W = (-v.x 0; -v.y
/// 0). W normally determines how the image of a cell moves with the lens point. Here, the first coordinate of
/// the lens point (LensShift::lens_px) stands for time. The view from the lens point (t, 0) shows the cell at
/// its position t frames later. Throws Error(out_of_memory).
[[nodiscard]] SheetMesh vector_sheets(const VectorFrame& frame);

/// Returns whether two neighbouring pixels belong to one surface. They do if their motion vectors agree
/// within 0.25 px.
///
/// They also do if the vectors agree within 2 px or a tenth of the longer, and the ids are equal. Without
/// ids, known depths must agree within 2 %.
[[nodiscard]] bool one_surface(const VectorPixel& a, const VectorPixel& b, bool has_z);

}  // namespace postlens
