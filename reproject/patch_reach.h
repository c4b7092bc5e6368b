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

    struct Bounds {
        float x0 = 0, x1 = 0, y0 = 0, y1 = 0;  ///< raster px
        /// Whether no pixel of [left, right] x [top, bottom] can be in it.
        [[nodiscard]] bool misses(float left, float right, float top, float bottom) const {
            return x1 < left || x0 > right || y1 < top || y0 > bottom;
        }
    };
    /// All of it lies within. `lens`: the lens's point; `shift`: by how much it moves everything, px.
    [[nodiscard]] Bounds bounds(const glm::vec2& lens, const glm::vec2& shift) const {
        const float at_x = x + shift.x - (xx * lens.x + xy * lens.y),
                    at_y = y + shift.y - (yx * lens.x + yy * lens.y);
        return {at_x - half_width, at_x + half_width, at_y - half_height, at_y + half_height};
    }
};

/// `farthest_px`: the greatest |x| and |y| of the lens's points; `shift_px`: of what moves everything.
[[nodiscard]] PatchReach patch_reach(const PatchMesh& mesh, const Patch& patch, const glm::dvec2& farthest_px,
                                     double shift_px);

}  // namespace postlens
