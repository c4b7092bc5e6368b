#include "reproject/patches/motion_strain.h"

#include <algorithm>

namespace postlens {

MotionStrain StrainOfMotions::operator()(const SheetKey& key, const RasterPoint& middle,
                                         const glm::dvec2& slope, const glm::dvec2& reach) const {
    const std::size_t motion = motion_class(key.path.bits() == 0 ? key.id : key.parent_id);
    MotionStrain most;
    for (const std::vector<RasterMap>& maps : views) {
        if (motion >= maps.size() || maps[motion].identity()) continue;
        const auto at = maps[motion].tangent(middle, slope, reach);
        if (!at) continue;
        most.px_m = std::max(most.px_m, glm::length(at->by_depth));
        most.bend_px = std::max(most.bend_px, at->bend_px);
    }
    return most;
}

}  // namespace postlens
