// Measures the edges of highlights by rays.
#pragma once

#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Measures the edges of bright surfaces with rays through the pinhole, because coarse records misjudge the
/// area of small highlights. In the pixels that such an edge crosses, the highlights of `mesh` are replaced
/// by those that the rays see. If the surface is seen directly, the new highlights also have its depth and
/// slope.
///
/// A pixel is measured if the light is smaller than a pixel, or if the records are farther apart than the
/// rays. It is not measured if a nearer surface hides a part of the light. In mirrors and glass, only lights
/// smaller than a pixel are measured.
///
/// If light reaches the border of what is measured, rays follow it into the pixels beyond, even where no
/// record meets it.
///
/// `less` is the radiance of the highlights. Nothing may move. The result depends only on the arguments.
void measure_edges(SheetMesh& mesh, const SightRays& rays, const LightElsewhere& less);

}  // namespace postlens
