// Converts a mesh of rays through a lens to an impulse response.
#pragma once

#include "lens/response_grid.h"
#include "lens/traced/traced_lens.h"

namespace postlens {

/// Converts traced rays to an impulse response: a grid of pixels of size `pitch_mm` > 0, with the energy that
/// the rays bring into each. `mesh` contains the rays from one object point, made by `TracedLens::impulse`.
/// The sum over all pixels is 1. If no ray passes the lens, returns an empty grid.
///
/// The chief ray lands at the centre of pixel (0, 0). Relative to it, the film point (x, y) has the pixel
/// coordinates (-x / pitch_mm, y / pitch_mm): film y points up and pixel y down, and the film's image is
/// upside down. Throws Error(wrong_arguments) if the response is wider than 4096 px.
[[nodiscard]] ResponseGrid mesh_response(const PupilMesh& mesh, double pitch_mm);

}  // namespace postlens
