// Converts a mesh of rays through a lens to an impulse response.
#pragma once

#include "lens/response_grid.h"
#include "lens/traced/traced_lens.h"

namespace postlens {

/// Returns the energy per pixel of size `pitch_mm` > 0 from a mesh of `TracedLens::impulse`, or nothing if no
/// ray passes. The sum is 1. The chief ray lands at the centre of pixel (0, 0), and film point (x, y) at (-x,
/// y) / pitch.
///
/// Throws Error(wrong_arguments) above 4096 px.
[[nodiscard]] ResponseGrid mesh_response(const PupilMesh& mesh, double pitch_mm);

}  // namespace postlens
