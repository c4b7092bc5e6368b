// The input of a convolution for motion blur: the image of a moving object, and a blur kernel. The kernel is
// the object's motion path, drawn into a raster.
#pragma once

#include <vector>

#include "motionblur/convolution/convolution.h"

namespace postlens {

/// Columns [begin, end) of a row, empty if begin >= end.
struct ColumnRange {
    int begin = 0, end = 0;
    [[nodiscard]] bool is_empty() const { return begin >= end; }
};

struct ConvolutionTask {
    const Planes& i1;
    const PathRaster& i2;
    CellWindow source;              ///< bounding box of the object's nonzero cells, over all planes
    CellWindow path;                ///< bounding box of the path's nonzero cells
    CellWindow out;                 ///< cells of the result that are wanted and that a nonzero cell may reach
    std::vector<ColumnRange> rows;  ///< for each row of `source`, the range of its nonzero columns

    /// Prepares the convolution of the image `a` of a moving object with the blur kernel `b`, an image of its
    /// motion path. The caller needs only the pixels of the result in the window `wanted`. `out` becomes the
    /// part of this window in which the result may differ from 0.
    ConvolutionTask(const Planes& a, const PathRaster& b, const CellWindow& wanted);

    [[nodiscard]] bool is_empty() const { return out.width() <= 0 || out.height() <= 0; }
    /// Returns a pointer p to row y of a plane (a colour channel or the coverage) of `i1`. `i1` is the image
    /// of a moving object, which is to be blurred. p[x] is the value in column x, where x and y are raster
    /// coordinates.
    [[nodiscard]] const float* row(std::size_t plane, int y) const {
        return i1.planes[plane].data() +
               static_cast<std::ptrdiff_t>(y - i1.y_begin) * static_cast<std::ptrdiff_t>(i1.width) -
               i1.x_begin;
    }
    [[nodiscard]] ColumnRange columns(int y) const {
        return rows[static_cast<std::size_t>(y - source.y_begin)];
    }
};

/// Creates `count` planes of zeros over the window. Throws Error(out_of_memory).
[[nodiscard]] Planes zero_planes(const CellWindow& window, std::size_t count);

/// Returns the bounding box of the convolution of two rasters with the bounding boxes `a` and `b`.
[[nodiscard]] CellWindow full_window(const CellWindow& a, const CellWindow& b);
[[nodiscard]] CellWindow window_of(const Planes& planes);
[[nodiscard]] CellWindow window_of(const PathRaster& raster);

}  // namespace postlens
