// Converts a mesh of rays through a lens to an impulse response.
#pragma once

#include "lens/response_grid.h"
#include "lens/traced/traced_lens.h"

namespace postlens {

/// Converts traced rays to an impulse response, which is the energy in each pixel of size `pitch_mm` > 0.
/// `mesh` is a grid of rays from one object point, made by `TracedLens::impulse`. The sum over all pixels is
/// 1. Returns nothing if no ray passes.
///
/// The chief ray lands at the centre of pixel (0, 0). The film point (x, y) has the pixel coordinates (-x /
/// pitch_mm, y / pitch_mm). Throws Error(wrong_arguments) if the response is wider than 4096 px.
[[nodiscard]] ResponseGrid mesh_response(const PupilMesh& mesh, double pitch_mm);

}  // namespace postlens
