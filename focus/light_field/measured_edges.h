// Measures the edges of highlights by rays.
#pragma once

#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Measures the edges of bright surfaces with rays through the pinhole, because coarse records misjudge the
/// area of small highlights. Replaces the highlights of `mesh` in the pixels that an edge crosses.
///
/// A pixel is measured if the light is smaller than a pixel, or if the records are farther apart than the
/// rays. `less` is the radiance of the highlights. Nothing may move.
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less);

}  // namespace postlens
