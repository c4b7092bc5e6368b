// Measures the edges of highlights by rays.
#pragma once

#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Measures small highlights of `mesh` again with rays, because coarse records misjudge their area. The scene
/// must be static.
/// - `less`: selects the surfaces whose bright light counts as highlights
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less);

}  // namespace postlens
