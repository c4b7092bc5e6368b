// The radius of the disc that a depth's level stands for.
#pragma once

#include <cmath>
#include <optional>

#include "focus/responses/depth_levels.h"

namespace postlens::test {

/// Of a circle of confusion of so many px of radius, where no number of depths is given.
inline double level_radius(double radius_px) {
    // Of which the diameter is the inverse depth.
    constexpr FocusGeometry unit{.aperture_radius_m = 0.5, .inverse_focus_per_m = 0, .gain_px = 1, .zoom = 1};
    static const DepthLevels levels(unit, {1, 1}, DepthSpacing::inverse, std::nullopt);
    return levels.radius_px()[*levels.level_of(2 * std::abs(radius_px))];
}

}  // namespace postlens::test
