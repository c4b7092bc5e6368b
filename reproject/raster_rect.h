// Rectangles of the raster.
#pragma once

#include <algorithm>
#include <limits>

namespace postlens {

/// A rectangle in raster px. It is initially empty.
struct RasterRect {
    double x_min = std::numeric_limits<double>::infinity(), x_max = -x_min, y_min = x_min, y_max = -x_min;
    void add(const RasterRect& o) {
        x_min = std::min(x_min, o.x_min);
        x_max = std::max(x_max, o.x_max);
        y_min = std::min(y_min, o.y_min);
        y_max = std::max(y_max, o.y_max);
    }
    [[nodiscard]] bool meets(double x0, double x1, double y0, double y1) const {
        return x_max >= x0 && x_min <= x1 && y_max >= y0 && y_min <= y1;
    }
};

}  // namespace postlens
