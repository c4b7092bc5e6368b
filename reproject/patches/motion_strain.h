// Bounds how much motion distorts a patch (nearly planar part of a surface). Patches with too large a
// distortion are divided into smaller ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/patches/patches.h"

namespace postlens {

/// While an object moves, the image of a part of its surface is stretched and bent. Computes the largest
/// distortion of this part during the exposure. Used as PatchLens::motion.
struct StrainOfMotions {
    /// The tested motions, at about `strain_views` instants of the exposure: views[i][g] moves the objects of
    /// group g, which move alike, from the time of recording to instant i.
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    [[nodiscard]] MotionStrain operator()(const SheetKey& key, const RasterPoint& middle,
                                          const glm::dvec2& slope, const glm::dvec2& reach) const;
};
/// Number of instants of the exposure at which motion is tested. It is prime, so that a periodic motion does
/// not have the same phase at all of them.
inline constexpr int strain_views = 17;

}  // namespace postlens
