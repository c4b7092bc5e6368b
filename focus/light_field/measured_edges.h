// Measures the edges of highlights by rays.
#pragma once

#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Measures the area of highlights with rays through the pinhole, where an edge of the highlight crosses a
/// pixel. Replaces the highlights of `mesh` there, because coarse records misjudge the area of small ones.
///
/// A pixel is measured if the light is smaller than a pixel, or if the records are farther apart than the
/// rays. `less` selects the light that counts as a highlight. Nothing may move.
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less);

}  // namespace postlens
