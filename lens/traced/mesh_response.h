// Converts a mesh of rays through a lens to an impulse response.
#pragma once

#include "lens/response_grid.h"
#include "lens/traced/traced_lens.h"

namespace postlens {

/// Returns the energy that each pixel of size `pitch_mm` > 0 receives from a mesh made by
/// `TracedLens::impulse`. The sum over all pixels is 1. x and y are raster axes (y down), in which the image
/// is upright: film point (x, y) is at (-x, y) / pitch. The chief ray, which passes through the centre of the
/// stop, lands at the centre of pixel (0, 0).
///
/// A mesh cell counts if the rays of all its four corners pass. Its light is distributed uniformly over 4 x 4
/// points of the bilinear patch between the corners. Returns an empty grid if no ray passes. Throws
/// Error(wrong_arguments) if the response is wider than 4096 px.
[[nodiscard]] ResponseGrid mesh_response(const PupilMesh& mesh, double pitch_mm);

}  // namespace postlens
