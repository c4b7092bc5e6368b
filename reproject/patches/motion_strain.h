// Bounds how much motion distorts a patch (nearly planar part of a surface). The bounds limit the size of the
// patch and the error of its depth plane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/patches/patches.h"

namespace postlens {

/// Implements PatchLens::motion: computes upper bounds of the distortion of a part of a surface by the
/// motions in all views.
struct StrainOfMotions {
    /// For each view, the motion of each class of objects that move alike (PatchView::Use::motions).
    /// `strain_views` views are sufficient if they are spread uniformly over the exposure.
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    /// Returns the maximum over the views, or 0 if the object does not move.
    [[nodiscard]] MotionStrain operator()(const SheetKey& key, const RasterPoint& middle,
                                          const glm::dvec2& slope, const glm::dvec2& reach) const;
};
inline constexpr int strain_views = 16;

}  // namespace postlens
