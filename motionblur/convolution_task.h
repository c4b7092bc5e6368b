// What both ways of convolving work on: the parts of i1 and i2 that are not 0, and where the result goes.
#pragma once

#include <vector>

#include "motionblur/convolution.h"

namespace postlens {

/// Columns [begin, end) of a row; empty where begin >= end.
struct ColumnRange {
    int begin = 0, end = 0;
    [[nodiscard]] bool is_empty() const { return begin >= end; }
};

struct ConvolutionTask {
    const Planes& i1;
    const PathRaster& i2;
    CellWindow source;              ///< where a plane of i1 is not 0
    CellWindow path;                ///< where i2 is not 0
    CellWindow out;                 ///< cells of the result that are wanted and that something may reach
    std::vector<ColumnRange> rows;  ///< by row of `source`: where a plane is not 0

    /// For i1 = a and i2 = b; `out` is empty where there is nothing to do.
    ConvolutionTask(const Planes& a, const PathRaster& b, const CellWindow& wanted);

    [[nodiscard]] bool is_empty() const { return out.width() <= 0 || out.height() <= 0; }
    /// Row y of a plane of i1, such that [x] is the cell in column x.
    [[nodiscard]] const float* row(std::size_t plane, int y) const {
        return i1.planes[plane].data() +
               static_cast<std::ptrdiff_t>(y - i1.y_begin) * static_cast<std::ptrdiff_t>(i1.width) -
               i1.x_begin;
    }
    [[nodiscard]] ColumnRange columns(int y) const {
        return rows[static_cast<std::size_t>(y - source.y_begin)];
    }
};

/// Planes of 0 over the window, first touched by all threads. Throws Error(out_of_memory).
[[nodiscard]] Planes zero_planes(const CellWindow& window, std::size_t count);

/// The windows' sum: where a full convolution lands.
[[nodiscard]] CellWindow full_window(const CellWindow& a, const CellWindow& b);
[[nodiscard]] CellWindow window_of(const Planes& planes);
[[nodiscard]] CellWindow window_of(const PathRaster& raster);

}  // namespace postlens
