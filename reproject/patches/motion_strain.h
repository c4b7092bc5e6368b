// Computes bounds of the distortion of a patch (nearly planar part of a surface) by motion. The bounds limit
// the patch's size and the error of its depth plane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/patches/patches.h"

namespace postlens {

/// A function object for PatchLens::motion. It computes bounds of the distortion of a part of a surface that
/// the motions in all views cause.
struct StrainOfMotions {
    /// For each view, the motion of each class of objects that move alike (PatchView::Use::motions). It is
    /// sufficient to use `strain_views` views that are spread uniformly over the shutter.
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    /// Returns the maximum over the views, or 0 if the object does not move.
    [[nodiscard]] MotionStrain operator()(const SheetKey& key, const RasterPoint& middle,
                                          const glm::dvec2& slope, const glm::dvec2& reach) const;
};
inline constexpr int strain_views = 16;

}  // namespace postlens
