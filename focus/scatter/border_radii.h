// Radii of the circles of confusion along the border of the traced area.
#pragma once

#include <cstdint>
#include <vector>

#include "focus/responses/node_response.h"
#include "records/quadtree.h"

namespace postlens {

/// Samples of the traced area lie at pixel corners. For each corner on the border of this area, the distance,
/// in px, to which the lens spreads the light of its sample. It is the CoC radius, or more with spherical
/// aberration.
struct BorderRadii {
    std::vector<float> top, bottom;  ///< per column, from x_begin on
    std::vector<float> left, right;  ///< per row, from y_begin on

    explicit BorderRadii(const RasterWindow& source);
    /// If a sample in row `y` lies on the border of the traced area, raises the blur radius stored for its
    /// position to at least `radius_px`. Several threads may add different rows.
    void note(const RasterWindow& source, const PointSample& sample, int y, double radius_px);
    /// If corners of the pixel (x, y) lie on the border of the traced area, raises the blur radii stored for
    /// these corners to at least `radius_px`.
    void note_pixel(const RasterWindow& source, int x, int y, double radius_px);
};

}  // namespace postlens
