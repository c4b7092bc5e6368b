// Which patches a view cannot have in a tile, found in less time than it takes to place them.
#pragma once

#include <cmath>

#include "reproject/patches.h"

namespace postlens {

/// Bounds of where a patch that does not move by itself comes to lie: its middle, which is affine in the
/// lens's point, and half of its extent, the greatest of all points.
struct PatchReach {
    float x = 0, y = 0;                     ///< raster px of the middle, as recorded
    float xx = 0, xy = 0, yx = 0, yy = 0;   ///< of the middle: W, 1/m
    float half_width = 0, half_height = 0;  ///< px

    /// Whether no pixel of [x0, x1] x [y0, y1], raster px, can be in it. `lens_px`: the lens's point;
    /// `shift`: by how much it moves everything, px.
    [[nodiscard]] bool misses(float lens_x, float lens_y, float shift_x, float shift_y, float x0, float x1,
                              float y0, float y1) const {
        const float at_x = x + shift_x - (xx * lens_x + xy * lens_y),
                    at_y = y + shift_y - (yx * lens_x + yy * lens_y);
        return at_x + half_width < x0 || at_x - half_width > x1 || at_y + half_height < y0 ||
               at_y - half_height > y1;
    }
};

/// `farthest_px`: the greatest |x| and |y| of the lens's points; `shift_px`: of what moves everything.
[[nodiscard]] PatchReach patch_reach(const PatchMesh& mesh, const Patch& patch, const glm::dvec2& farthest_px,
                                     double shift_px);

}  // namespace postlens
