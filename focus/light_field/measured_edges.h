// Measures the edges of highlights by rays.
#pragma once

#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Replaces the highlights of `mesh` in the pixels that the edge of a bright surface crosses. The new
/// highlights are those that rays through the pinhole see. If the surface is seen directly, they also have
/// its depth and slope. This corrects the area of small highlights, which coarse records misjudge.
///
/// A pixel is measured if the light is smaller than a pixel, or if the records of the pixel and its
/// neighbours are farther apart than the rays. It is not measured if a nearer surface hides a part of the
/// light, because rays through the pinhole do not reach that part. In mirrors and glass, only lights smaller
/// than a pixel are measured.
///
/// `less` is the radiance of the highlights. Nothing may move. The result depends only on the arguments.
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less);

}  // namespace postlens
