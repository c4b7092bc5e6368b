// Measures the edges of highlights by rays.
#pragma once

#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Measures the edges of bright surfaces with rays through the pinhole, because coarse records misjudge the
/// area of small highlights. In the pixels that an edge crosses, the highlights of `mesh` are replaced by
/// those that rays see. If seen directly, they also get the depth and slope of the surface.
///
/// A pixel is measured if the light is smaller than a pixel, or if the records are farther apart than the
/// rays. In mirrors and glass, only lights smaller than a pixel are measured. Partly hidden light is not
/// measured. Rays follow the light into pixels beyond, even where no record meets it.
///
/// `less` is the radiance of the highlights. Nothing may move. The result depends only on the arguments.
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less);

}  // namespace postlens
