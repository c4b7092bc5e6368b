// Which highlights the lens spreads by its exact response where rays look as well, and how much light they
// have.
#pragma once

#include "reproject/sheet_mesh.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// A ray cannot tell which light of a surface it meets: of each surface (by chain of bounces and ids, and
/// what is seen directly and stands still by square of its sheet) either all light above the limit is taken,
/// or none, and none where rays would not know it (SightRays::steady) or something stands before part of it.
/// Makes `rule` and the sheets so, and gives what rays are then not to see.
[[nodiscard]] LightElsewhere leave_to_lens(TreeSheets& sheets, const SightRays& rays, bool moves,
                                           HighlightRule& rule);

}  // namespace postlens
