// Selects the highlights that are spread by their impulse response, for images in which rays replace some
// view samples.
#pragma once

#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Restricts `rule` so that rays can tell which radiance is a highlight, applies it to `sheets`, and returns
/// the radiance that rays must leave out.
///
/// A ray only knows which surface it hits. So either all radiance of a surface above the limit is a
/// highlight, or none of it is. None of it is a highlight if rays get different radiance from the surface
/// (SightRays::steady), or if a nearer surface hides a part of the highlight. A surface is identified by its
/// path and ids, and, if it is seen directly and does not move, also by its square of the raster.
[[nodiscard]] LightElsewhere leave_to_lens(TreeSheets& sheets, const SightRays& rays, bool moves,
                                           HighlightRule& rule);

}  // namespace postlens
