// A cheap test that excludes patches outside a tile before their map is computed.
#pragma once

#include <cmath>

#include "reproject/patches/patches.h"

namespace postlens {

/// Bounds, in any view, of a patch that does not move: its centre, which is an affine function of the lens
/// point, and half of its largest extent over all lens points.
struct PatchReach {
    float x = 0, y = 0;                     ///< centre in the pinhole's view, raster px
    float xx = 0, xy = 0, yx = 0, yy = 0;   ///< W of the centre, 1/m
    float half_width = 0, half_height = 0;  ///< px

    struct Bounds {
        float x0 = 0, x1 = 0, y0 = 0, y1 = 0;  ///< raster px
        /// Whether these bounds are disjoint from the rectangle [left, right] x [top, bottom].
        [[nodiscard]] bool misses(float left, float right, float top, float bottom) const {
            return x1 < left || x0 > right || y1 < top || y0 > bottom;
        }
    };
    /// Bounding rectangle of the patch for one view. `lens`: LensShift::lens_px; `shift`: the shift of a node
    /// at infinity (W = 0), px.
    [[nodiscard]] Bounds bounds(const glm::vec2& lens, const glm::vec2& shift) const {
        const float at_x = x + shift.x - (xx * lens.x + xy * lens.y),
                    at_y = y + shift.y - (yx * lens.x + yy * lens.y);
        return {at_x - half_width, at_x + half_width, at_y - half_height, at_y + half_height};
    }
};

/// `farthest_px`: largest |x| and |y| of all views' LensShift::lens_px; `shift_px`: largest shift of a node
/// at infinity.
[[nodiscard]] PatchReach patch_reach(const PatchMesh& mesh, const Patch& patch, const glm::dvec2& farthest_px,
                                     double shift_px);

}  // namespace postlens
