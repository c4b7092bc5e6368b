// Highlights (very bright light) can be added to an image by blur kernels or by traced rays. This file
// chooses those that blur kernels add, if the image is also corrected by traced rays. The rays must then
// leave out this light, because it would count twice otherwise.
#pragma once

#include "reproject/patches/patches.h"
#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Decides which highlights are spread by blur kernels in an image that is also corrected by traced rays.
/// Restricts `rule` to these highlights. Returns their light, which rays must leave out so that it is not
/// counted twice.
///
/// A ray recognises only the surface that it hits. So either all bright light of a surface is spread by blur
/// kernels, or none. None is in these cases:
/// - different rays see different radiance at a point of the surface (SightRays::steady is false)
/// - the file lacks some of the surface's bright light
/// - the light fills most of the area over which it is blurred, because images from many lens points then
///   show it
[[nodiscard]] LightElsewhere leave_to_lens(TreeSheets& sheets, const SightRays& rays, const PatchLens& lens,
                                           bool moves, HighlightRule& rule);

}  // namespace postlens
