// Radii of the circles of confusion along the border of the traced area.
#pragma once

#include <cstdint>
#include <vector>

#include "focus/responses/node_response.h"
#include "records/quadtree.h"

namespace postlens {

/// Blur radii, in px, along the border of the traced area, which tell whether more overscan is needed.
struct BorderRadii {
    std::vector<float> top, bottom;  ///< per column, from x_begin on
    std::vector<float> left, right;  ///< per row, from y_begin on

    explicit BorderRadii(const RasterWindow& source);
    /// If a sample in row y lies on the border of the traced area, `source`, stores its blur radius for its
    /// column or row of this border. If a larger radius is already stored there, it is kept. Thread-safe for
    /// different rows.
    void note(const RasterWindow& source, const PointSample& sample, int y, double radius_px);
    /// Stores the blur radius of a pixel, `radius_px`, for each corner of the pixel (x, y) that lies on the
    /// border of the traced area. A larger radius that is stored there already is kept.
    void note_pixel(const RasterWindow& source, int x, int y, double radius_px);
};

}  // namespace postlens
