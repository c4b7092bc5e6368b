// Computes how much the motion of an object distorts the image of a patch (nearly planar part of its
// surface). A patch is reprojected by an affine map, so if the distortion is too large, the patch is divided
// into smaller ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "reproject/patches/patches.h"

namespace postlens {

/// Computes how much the motion during the exposure distorts the image of a patch (small part of a surface).
/// The motion is evaluated at several instants, and the result is the largest distortion. This decides how
/// finely surfaces are divided into patches.
struct StrainOfMotions {
    /// Motions of the objects during the exposure, evaluated at several instants (about `strain_views`).
    /// Objects that move alike form a group. views[i][g] is a map for the group g: it leads from a position
    /// on the raster where the group was recorded to its position at the evaluated instant number i.
    std::vector<std::vector<RasterMap>> views;
    std::function<std::size_t(std::uint32_t id)> motion_class;

    [[nodiscard]] MotionStrain operator()(const SheetKey& key, const RasterPoint& middle,
                                          const glm::dvec2& slope, const glm::dvec2& reach) const;
};
/// Approximate number of instants of the exposure at which the motion of objects is evaluated. It is prime.
/// Otherwise, a periodic motion, such as a vibration, might have the same phase at all of these instants, and
/// would then seem not to move.
inline constexpr int strain_views = 17;

}  // namespace postlens
