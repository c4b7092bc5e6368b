// Measures the edges of highlights by rays.
#pragma once

#include "reproject/patches/patches.h"
#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Measures the area of small highlights, and of the edges of large ones, with traced rays, because the
/// samples in the file are too coarse for this. Stores the result in `mesh`. The scene must be static.
/// - `less`: states for which surfaces the bright light is added to the image by blur kernels; only these are
///   measured
/// - `lens`: the lens, because the edges of almost sharp, bright highlights are measured more finely
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less, const PatchLens& lens);

}  // namespace postlens
