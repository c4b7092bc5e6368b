// Measures the edges of highlights by rays.
#pragma once

#include "reproject/patches/patches.h"
#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Measures the area of small highlights in `mesh` with traced rays, because the samples in the file are too
/// coarse for small areas. The scene must be static.
/// - `less`: states which surfaces have bright light that is added to the image as highlights; only these are
///   measured
/// - `lens`: the lens, because the edges of almost sharp, bright highlights are measured more finely
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less, const PatchLens& lens);

}  // namespace postlens
