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
    /// For each view, the motions of all groups of objects that move alike. It suffices to sample
    /// `strain_views` instants, uniform over the exposure.
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    [[nodiscard]] MotionStrain operator()(const SheetKey& key, const RasterPoint& middle,
                                          const glm::dvec2& slope, const glm::dvec2& reach) const;
};
/// A prime number of views, so that a periodic motion does not have the same phase in all of them.
inline constexpr int strain_views = 17;

}  // namespace postlens
