// A mesh of rays laid on the pixel grid.
#pragma once

#include "lens/prescription/traced_lens.h"
#include "lens/response_grid.h"

namespace postlens {

/// What `TracedLens::impulse` filled, as energy per pixel of `pitch_mm` > 0, all together 1; x and y as on
/// the raster, where the picture is upright: film point (x, y) is at (-x, y) / pitch, y down. The chief ray
/// lands at the middle of pixel (0, 0). Each cell of the mesh whose corners pass spreads its light evenly
/// over 4 x 4 points of the bilinear patch they span. Throws Error(wrong_arguments) where the response is
/// wider than 4096 px. Empty where nothing passes.
[[nodiscard]] ResponseGrid mesh_response(const PupilMesh& mesh, double pitch_mm);

}  // namespace postlens
