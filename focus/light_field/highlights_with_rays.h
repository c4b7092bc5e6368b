// Selects the highlights that are spread by their impulse responses, for images in which rays replace some
// samples of views.
#pragma once

#include "reproject/patches/patches.h"
#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Restricts `rule` to highlights that a ray can recognise, applies it to `sheets`, and returns the radiance
/// that rays must leave out.
///
/// A ray only identifies the surface that it hits. So for each surface, either all radiance above the limit
/// is a highlight, or none is. None is a highlight if rays get different radiance from the surface
/// (SightRays::steady), or if the records do not contain the highlight completely. A surface is identified by
/// its path and ids. If it is seen directly and does not move, it is also identified by its square of the
/// raster.
///
/// Unless something moves, rays then measure the edges of the highlights (measure_edges).
[[nodiscard]] LightElsewhere leave_to_lens(TreeSheets& sheets, const SightRays& rays, const PatchLens& lens,
                                           bool moves, HighlightRule& rule);

}  // namespace postlens
