// Quickly excludes patches (planar parts of surfaces) outside a tile, before they are mapped into the view.
#pragma once

#include <cmath>

#include "reproject/patches/patches.h"

namespace postlens {

/// Bounds of a static patch in any view. Its centre moves linearly with the lens point; `half_width` and
/// `half_height` hold for all views.
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
    /// Returns the patch's bounding rectangle in one view. `lens` is LensShift::lens_px, in px m; `shift` is
    /// the displacement of infinitely distant points, in px.
    [[nodiscard]] Bounds bounds(const glm::vec2& lens, const glm::vec2& shift) const {
        const float at_x = x + shift.x - (xx * lens.x + xy * lens.y),
                    at_y = y + shift.y - (yx * lens.x + yy * lens.y);
        return {at_x - half_width, at_x + half_width, at_y - half_height, at_y + half_height};
    }
};

/// Bounds a patch in all views. `farthest_px` is the largest |x| and |y| of LensShift::lens_px. `shift_px` is
/// the largest shift of surfaces at infinity, in px.
[[nodiscard]] PatchReach patch_reach(const PatchMesh& mesh, const Patch& patch, const glm::dvec2& farthest_px,
                                     double shift_px);

}  // namespace postlens
