// Measures the edges of highlights by rays.
#pragma once

#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Measures the area of highlights with rays through the pinhole, in pixels that an edge of a highlight
/// crosses. Replaces the highlights of `mesh` in these pixels, because coarse records misjudge the area of
/// small highlights.
///
/// A pixel is measured if the highlight is smaller than a pixel, or if the records are farther apart than the
/// rays. `less` selects the surfaces whose bright light counts as highlights. The scene must be static.
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less);

}  // namespace postlens
