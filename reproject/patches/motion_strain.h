// Upper bounds of the distortion of a patch (nearly planar part of a surface) by motion. A patch that would
// be distorted too much is divided.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/patches/patches.h"

namespace postlens {

/// Computes upper bounds of the distortion of a part of a surface by the motions in all views
/// (PatchLens::motion).
struct StrainOfMotions {
    /// For each view, the motions of all classes of objects that move alike (PatchView::Use::motions).
    /// Instead of all views, `strain_views` views that are spread uniformly over the exposure are sufficient.
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    /// Returns the largest distortion in any of the views, or 0 if the object does not move.
    [[nodiscard]] MotionStrain operator()(const SheetKey& key, const RasterPoint& middle,
                                          const glm::dvec2& slope, const glm::dvec2& reach) const;
};
/// It is prime, so that few motions that repeat are in the same phase in all of these views.
inline constexpr int strain_views = 17;

}  // namespace postlens
