// Converts a mesh of rays through a lens to an impulse response.
#pragma once

#include "lens/response_grid.h"
#include "lens/traced/traced_lens.h"

namespace postlens {

/// Returns the energy per pixel of size `pitch_mm` > 0 from a mesh of `TracedLens::impulse`; the sum is 1.
/// The chief ray lands at the centre of pixel (0, 0). The image is upright: film point (x, y) is at (-x, y) /
/// pitch.
///
/// Returns an empty grid if no ray passes. Throws Error(wrong_arguments) if the response is wider than 4096
/// px.
[[nodiscard]] ResponseGrid mesh_response(const PupilMesh& mesh, double pitch_mm);

}  // namespace postlens
