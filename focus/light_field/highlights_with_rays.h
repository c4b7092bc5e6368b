// Selects the highlights that are spread by blur kernels if rays are also traced to correct the image.
#pragma once

#include "reproject/patches/patches.h"
#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Restricts `rule`, which selects the highlights to be spread by blur kernels. Returns the selected light,
/// which rays must leave out.
///
/// A ray recognises only which surface it hits, so all bright light of a surface is selected, or none. None
/// is selected if:
/// - different rays see different radiance on the surface (SightRays::steady is false)
/// - the file lacks some of the surface's bright light
/// - the light fills most of its blur, because images from many lens points then show it
[[nodiscard]] LightElsewhere leave_to_lens(TreeSheets& sheets, const SightRays& rays, const PatchLens& lens,
                                           bool moves, HighlightRule& rule);

}  // namespace postlens
