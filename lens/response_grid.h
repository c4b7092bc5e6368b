// An impulse response on the pixel grid: the image of a point light source.
#pragma once

#include <cstddef>
#include <vector>

namespace postlens {

/// An impulse response: the energy of a point light source in each pixel of a rectangle. Values add up to 1,
/// unless light is lost.
struct ResponseGrid {
    /// Position of the top left pixel of the rectangle that the impulse response covers, in px with y down.
    /// The position is relative to the pixel at which the impulse response is added to an image.
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
