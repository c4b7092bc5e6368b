// Selects the highlights that are spread by their impulse response in images that also have rays.
#pragma once

#include "reproject/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// A ray that hits a surface cannot know which part of the surface's radiance is a highlight. So per surface
/// (path and ids; for primary nodes that do not move also the square of the sheet) either all radiance above
/// the limit is a highlight or none is. None is if rays get different radiance there (SightRays::steady), or
/// if a nearer surface hides a part of it. Restricts `rule` accordingly, applies it to the sheets, and
/// returns the radiance that rays must leave out.
[[nodiscard]] LightElsewhere leave_to_lens(TreeSheets& sheets, const SightRays& rays, bool moves,
                                           HighlightRule& rule);

}  // namespace postlens
