// Bounds how much motion distorts a patch (nearly planar part of a surface). Patches with too large a
// distortion are divided into smaller ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/patches/patches.h"

namespace postlens {

/// While an object moves, the image of a part of its surface is stretched and bent. This function returns the
/// greatest such effects at some instants of the exposure (MotionStrain). Used as PatchLens::motion, which
/// decides how finely surfaces are divided.
struct StrainOfMotions {
    /// Motions of the objects during the exposure, as maps on the raster. Objects that move alike form a
    /// group, whose number is g. The exposure is sampled at about `strain_views` instants, whose number is i.
    /// views[i][g] maps the position of group g at the recorded instant to its position at instant i.
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    [[nodiscard]] MotionStrain operator()(const SheetKey& key, const RasterPoint& middle,
                                          const glm::dvec2& slope, const glm::dvec2& reach) const;
};
/// Approximate number of instants of the exposure at which motion is tested for distortion. The number is
/// prime. Otherwise, a periodic motion, such as a vibration, might have the same phase at all of these
/// instants, and would then seem not to move.
inline constexpr int strain_views = 17;

}  // namespace postlens
