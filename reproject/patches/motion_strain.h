// Computes bounds of how much motion distorts a patch (nearly planar part of a surface). If the distortion is
// too large, the patch is divided.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/patches/patches.h"

namespace postlens {

/// Computes upper bounds of how much the motions in all views distort a part of a surface
/// (PatchLens::motion).
struct StrainOfMotions {
    /// For each view, the motions of all classes of objects that move alike (PatchView::Use::motions). Not
    /// all views of an image are needed: `strain_views` views suffice if they are spread uniformly over the
    /// exposure.
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    /// Returns the largest distortion in any of the views, or 0 if the object does not move.
    [[nodiscard]] MotionStrain operator()(const SheetKey& key, const RasterPoint& middle,
                                          const glm::dvec2& slope, const glm::dvec2& reach) const;
};
inline constexpr int strain_views = 16;

}  // namespace postlens
