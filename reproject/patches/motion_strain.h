// Upper bounds of the distortion of a patch (nearly planar part of a surface) by motion. Patches with too
// large distortion are divided.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/patches/patches.h"

namespace postlens {

/// Bounds the distortion of a part of a surface by the motions in all views (PatchLens::motion).
struct StrainOfMotions {
    /// For each view, the motions of all classes of objects that move alike (PatchView::Use::motions).
    /// `strain_views` views, uniform over the exposure, suffice.
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    /// Returns the largest distortion in any of the views, or 0 if the object does not move.
    [[nodiscard]] MotionStrain operator()(const SheetKey& key, const RasterPoint& middle,
                                          const glm::dvec2& slope, const glm::dvec2& reach) const;
};
/// A prime number of views, so that a periodic motion does not have the same phase in all of them.
inline constexpr int strain_views = 17;

}  // namespace postlens
