// i1 of a moving group, its convolution with i2, and the result in pixels.
#pragma once

#include <optional>
#include <vector>

#include "motionblur/band_surfaces.h"
#include "motionblur/convolution.h"

namespace postlens {

/// Premultiplied colour and coverage over a window of pixels: r, g, b, coverage.
struct GroupPicture {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    std::vector<std::array<float, 4>> rgba;
    [[nodiscard]] const std::array<float, 4>* at(int x, int y) const {
        if (x < x_begin || x >= x_end || y < y_begin || y >= y_end) return nullptr;
        return &rgba[static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(x_end - x_begin) +
                     static_cast<std::size_t>(x - x_begin)];
    }
};

/// Cells to a pixel for a group: a path along neither axis, or a short one, needs finer ones.
[[nodiscard]] int cells_for(const MovingGroup& group);

/// The cells that a group's records can lie in, within the rows and columns that `bands` have.
[[nodiscard]] CellWindow group_window(const std::vector<BandSurfaces>& bands, const MovingGroup& group,
                                      int cells_per_px);

/// Cells that the quarter of a leaf next to a corner covers: [x, x + n) x [y, y + n), each with this share of
/// its area. Leaves are dyadic, so a quarter covers whole cells or lies within one.
struct QuarterCells {
    int x = 0, y = 0, n = 1;
    float share = 1;
};
[[nodiscard]] QuarterCells quarter_cells(const PointSample& leaf_at, float leaf_size, std::size_t corner,
                                         int cells_per_px);

/// The group's surface at a point sample: the nearest of them; nullptr: none.
[[nodiscard]] const LayerSurface* surface_of(const BandSurfaces& band, std::uint32_t sample,
                                             const GroupTable& table, int g);

/// i1 of group g: at every place the nearest surface of the group that is recorded there, hidden ones
/// included; cells of 1/cells_per_px px.
[[nodiscard]] Planes draw_group(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                                const MovingGroup& group, int cells_per_px);

/// The cells' means over whole pixels, of those that lie in the frame.
[[nodiscard]] GroupPicture in_pixels(const Planes& cells, int cells_per_px, int width, int height);

}  // namespace postlens
