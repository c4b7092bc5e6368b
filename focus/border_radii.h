// How wide the circles of confusion are where the records end.
#pragma once

#include <cstdint>
#include <vector>

#include "focus/node_response.h"
#include "records/quadtree.h"

namespace postlens {

/// Largest radius of the CoC, px, per corner along the outermost recorded rows and columns.
struct BorderRadii {
    std::vector<float> top, bottom;  ///< by column, first at x_begin
    std::vector<float> left, right;  ///< by row, first at y_begin

    explicit BorderRadii(const RasterWindow& source);
    /// Takes in the CoC of a sample in pixel row y of the source. Different rows at the same time are safe.
    void note(const RasterWindow& source, const PointSample& sample, int y, double radius_px);
    /// The same of pixel (x, y), for all of its corners.
    void note_pixel(const RasterWindow& source, int x, int y, double radius_px);
};

}  // namespace postlens
