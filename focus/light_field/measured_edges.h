// Measures the edges of highlights by rays.
#pragma once

#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Replaces the highlights of `mesh` in the pixels that the edge of a bright surface crosses by those that
/// rays through the pinhole see, with the depths and slopes of surfaces that are seen directly. Coarse
/// records misjudge the area of a small highlight, by 0.16 px^2 in a pixel if they are half a pixel apart.
///
/// A pixel is measured if its records and those of its neighbours are farther apart than the rays, or if the
/// light is smaller than a pixel, and if no nearer surface hides a part, which rays through the pinhole do
/// not reach. Of lights in mirrors and glass, only those smaller than a pixel are measured: the records do
/// not say whether a nearer surface hides the mirror. `less`: the radiance of the highlights. Nothing may
/// move. The result depends only on the arguments.
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less);

}  // namespace postlens
