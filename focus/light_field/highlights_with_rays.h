// Selects the highlights that are spread by their impulse responses in images that use rays.
#pragma once

#include "reproject/patches/patches.h"
#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Restricts `rule`, which selects highlights, to those that a ray can recognise. Returns their radiance,
/// which rays must leave out.
///
/// A ray knows only which surface it hits, so all bright light of a surface is selected, or none. None is
/// selected if:
/// - different rays get different radiance (SightRays::steady)
/// - the records lack some of the surface's bright light
/// - the light fills most of its blur, because many views then show it
[[nodiscard]] LightElsewhere leave_to_lens(TreeSheets& sheets, const SightRays& rays, const PatchLens& lens,
                                           bool moves, HighlightRule& rule);

}  // namespace postlens
