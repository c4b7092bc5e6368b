// Turns an image with motion vectors into sheets: connected surfaces whose pixels have velocities.
#pragma once

#include "motionblur/vectors/vector_frame.h"
#include "reproject/sheets/sheet_mesh.h"

namespace postlens {

/// Ids of the sheets that `vector_sheets` makes.
inline constexpr std::uint32_t still_id = 0, moving_id = 1;

/// Converts an image with motion vectors to sheets, connected surfaces within squares of the raster. Every
/// pixel becomes a cell of one colour and one depth, since a pixel is the mean over its square. As the views'
/// sample positions are spread over the pixel, static pixels keep their bits and moving edges between pixels
/// get the right coverage.
///
/// At a pixel corner, those of the four pixels that belong to one surface share the mean of their vectors, so
/// that a surface that rotates or grows has no cracks. Different surfaces separate. Pixels of the display
/// window that the file does not store are black, static and infinitely far.
///
/// A cell's W holds its velocity v, px per frame to the right and down, as (-v.x 0; -v.y 0). The view from
/// the lens point (t, 0) (LensShift::lens_px) therefore shows the cell at its position t frames later. Throws
/// Error(out_of_memory).
[[nodiscard]] SheetMesh vector_sheets(const VectorFrame& frame);

/// Whether two neighbouring pixels are one surface. Their vectors must agree within 2 px or 10 % of the
/// longer one, and their depths within 2 %; equal ids replace equal depths if both pixels have an id. Without
/// depths and ids only the vectors count. Vectors within 0.25 px suffice whatever the depths, which keeps a
/// floor near the horizon, with its steep depths, in one piece.
[[nodiscard]] bool one_surface(const VectorPixel& a, const VectorPixel& b, bool has_z);

}  // namespace postlens
