// The radius of the disc by which a depth level is drawn.
#pragma once

#include <cmath>
#include <optional>

#include "focus/responses/depth_levels.h"

namespace postlens::test {

/// The radius of the level of a CoC of radius `radius_px`, px, when the number of depths is not given.
inline double level_radius(double radius_px) {
    // With this geometry, the diameter of the CoC in px is the inverse depth.
    constexpr FocusGeometry unit{.aperture_radius_m = 0.5, .inverse_focus_per_m = 0, .gain_px = 1, .zoom = 1};
    static const DepthLevels levels(unit, {1, 1}, DepthSpacing::inverse, std::nullopt);
    return levels.radius_px()[*levels.level_of(2 * std::abs(radius_px))];
}

}  // namespace postlens::test
