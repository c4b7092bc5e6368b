// Measures the edges of highlights by rays.
#pragma once

#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Measures the area of small highlights in `mesh` with rays, because the recorded samples are too coarse for
/// small areas. The scene must be static.
/// - `less`: tells which surfaces' bright light counts as highlights
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less);

}  // namespace postlens
