// Radii of the circles of confusion at the border of the records.
#pragma once

#include <cstdint>
#include <vector>

#include "focus/responses/node_response.h"
#include "records/quadtree.h"

namespace postlens {

/// Largest distance at which light arrives, at each corner of the outermost recorded rows and columns, px:
/// the CoC radius, or more with spherical aberration.
struct BorderRadii {
    std::vector<float> top, bottom;  ///< per column, from x_begin on
    std::vector<float> left, right;  ///< per row, from y_begin on

    explicit BorderRadii(const RasterWindow& source);
    /// Updates the radii with that of a sample in pixel row y of the source. Several threads may add
    /// different rows at the same time.
    void note(const RasterWindow& source, const PointSample& sample, int y, double radius_px);
    /// Updates the radii at all corners of the pixel (x, y) with the given radius.
    void note_pixel(const RasterWindow& source, int x, int y, double radius_px);
};

}  // namespace postlens
