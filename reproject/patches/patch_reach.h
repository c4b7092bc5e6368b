// Computes, for any lens point, a rectangle that contains the image of a patch (planar part of a surface). If
// the rectangle lies outside the tile (square of the image) that is being drawn, the patch need not be drawn.
#pragma once

#include <cmath>

#include "reproject/patches/patches.h"

namespace postlens {

/// Data for the rectangle that contains the image of a static patch (planar part of a surface), as seen from
/// any lens point. The centre of the rectangle moves linearly with the lens point. Its size is constant, and
/// large enough for all lens points.
struct PatchReach {
    float x = 0, y = 0;                     ///< centre in the pinhole's view, raster px
    float xx = 0, xy = 0, yx = 0, yy = 0;   ///< W of the centre, 1/m
    float half_width = 0, half_height = 0;  ///< px

    struct Bounds {
        float x0 = 0, x1 = 0, y0 = 0, y1 = 0;  ///< raster px
        [[nodiscard]] bool misses(float left, float right, float top, float bottom) const {
            return x1 < left || x0 > right || y1 < top || y0 > bottom;
        }
    };
    /// Returns a rectangle that contains the image of the patch (planar part of a surface) as seen from one
    /// lens point.
    /// - `lens`: the lens point (LensShift::lens_px)
    /// - `shift`: displacement, in px, of the image of infinitely distant points as seen from this lens point
    [[nodiscard]] Bounds bounds(const glm::vec2& lens, const glm::vec2& shift) const {
        const float at_x = x + shift.x - (xx * lens.x + xy * lens.y),
                    at_y = y + shift.y - (yx * lens.x + yy * lens.y);
        return {at_x - half_width, at_x + half_width, at_y - half_height, at_y + half_height};
    }
};

/// Prepares PatchReach::bounds, which computes a rectangle that contains the image of the patch (planar part
/// of a surface) for a given lens point.
/// - `farthest_px`: largest |x| and |y| of all lens points (LensShift::lens_px)
/// - `shift_px`: largest displacement, over all lens points, of the image of an infinitely distant point
[[nodiscard]] PatchReach patch_reach(const PatchMesh& mesh, const Patch& patch, const glm::dvec2& farthest_px,
                                     double shift_px);

}  // namespace postlens
