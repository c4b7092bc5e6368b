// Converts a mesh of rays to an impulse response on the pixel grid.
#pragma once

#include "lens/response_grid.h"
#include "lens/traced/traced_lens.h"

namespace postlens {

/// Returns the energy per pixel of size `pitch_mm` > 0 of a mesh from `TracedLens::impulse`; the sum is 1. x
/// and y are those of the raster, where the image is upright: film point (x, y) is at (-x, y) / pitch, y
/// down. The chief ray lands at the centre of pixel (0, 0). Each cell of the mesh whose four corners pass
/// distributes its light uniformly over 4 x 4 points of the bilinear patch between them. Throws
/// Error(wrong_arguments) if the response is wider than 4096 px. Empty if nothing passes.
[[nodiscard]] ResponseGrid mesh_response(const PupilMesh& mesh, double pitch_mm);

}  // namespace postlens
