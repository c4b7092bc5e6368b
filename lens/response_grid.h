// An impulse response laid on the pixel grid: what one point of light becomes on the film.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

/// Energy per pixel of a rectangle of pixels. Coordinates are px relative to a whole coordinate of the
/// raster, the anchor: pixel (i, j) of the grid covers [x_begin + i, x_begin + i + 1) x [y_begin + j, y_begin
/// + j + 1), x to the right, y down. Where the point's geometric image lies between the pixels (its phase) is
/// up to who made it. Values are not negative; all pixels of the plane together hold 1 but for losses that
/// the maker states.
struct ResponseGrid {
    int x_begin = 0, y_begin = 0;
    int width = 0, height = 0;
    std::vector<double> share;  ///< row by row, width * height

    ResponseGrid() = default;
    ResponseGrid(int x, int y, int w, int h)
        : x_begin(x),
          y_begin(y),
          width(w),
          height(h),
          share(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

    /// i in [0, width), j in [0, height).
    [[nodiscard]] double& at(int i, int j) {
        return share[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(i)];
    }
    [[nodiscard]] double at(int i, int j) const {
        return share[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(i)];
    }
};

}  // namespace postlens
