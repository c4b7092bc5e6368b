// A picture with motion vectors as sheets that move by themselves.
#pragma once

#include "motionblur/vector_frame.h"
#include "reproject/sheet_mesh.h"

namespace postlens {

/// Ids of what `vector_sheets` makes.
inline constexpr std::uint32_t still_id = 0, moving_id = 1;

/// Every pixel is a cell of one colour and one depth, since a pixel is the mean over its square: seen from
/// places spread over the pixel, what stands still keeps its bits and an edge between pixels has the coverage
/// that it should. Where four pixels meet, those that are one surface share the mean of their vectors, so
/// that a surface that turns or grows has no cracks; the others part. Pixels of the display window that the
/// file does not store are black, still and infinitely far.
///
/// A cell's W is its velocity v, px per frame to the right and down, as (-v.x 0; -v.y 0): seen through the
/// point (t, 0) of the lens (LensShift::lens_px) it lies where it is t frames after this one. Throws
/// Error(out_of_memory).
[[nodiscard]] SheetMesh vector_sheets(const VectorFrame& frame);

/// Whether two neighbours are one surface. Depths within 2 % and vectors within 2 px or 10 % of the longer;
/// or vectors within 0.25 px, whatever the depths: a floor near the horizon has steep depths and must not
/// tear. Where both have ids these stand in for the depths. Without either the vectors decide.
[[nodiscard]] bool one_surface(const VectorPixel& a, const VectorPixel& b, bool has_z);

}  // namespace postlens
