// Selects the highlights that are spread by their impulse responses in images that use rays.
#pragma once

#include "reproject/patches/patches.h"
#include "reproject/sheets/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// Restricts `rule` to highlights that a ray can recognise and applies it to `sheets`. Returns the radiance
/// that rays must leave out.
///
/// A ray can only tell which surface it hits. For each surface, therefore, either all radiance above the
/// limit is a highlight, or none. A surface has no highlights if rays get different radiance from it
/// (SightRays::steady), or if the records do not contain all of its bright light.
///
/// If nothing moves, rays then measure the edges of the highlights (measure_edges).
[[nodiscard]] LightElsewhere leave_to_lens(TreeSheets& sheets, const SightRays& rays, const PatchLens& lens,
                                           bool moves, HighlightRule& rule);

}  // namespace postlens
