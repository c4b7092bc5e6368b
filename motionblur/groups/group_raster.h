// Draws the unblurred raster of a moving group (i1 in [potmesil1983]).
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "motionblur/convolution/convolution.h"
#include "motionblur/groups/band_surfaces.h"

namespace postlens {

/// Red, green, blue and coverage over a window of pixels. Colours are premultiplied.
struct GroupPicture {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    std::vector<std::array<float, 4>> rgba;
    [[nodiscard]] const std::array<float, 4>* at(int x, int y) const {
        if (x < x_begin || x >= x_end || y < y_begin || y >= y_end) return nullptr;
        return &rgba[static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(x_end - x_begin) +
                     static_cast<std::size_t>(x - x_begin)];
    }
};

/// Returns the resolution at which a group of moving objects is blurred, in raster cells per px.
/// Displacements along the motion path are rounded to whole cells. For short or slanted paths, the error of
/// this rounding is visible, so they need a higher resolution.
[[nodiscard]] int cells_for(const MovingGroup& group);

[[nodiscard]] CellWindow group_window(const std::vector<BandSurfaces>& bands, const MovingGroup& group,
                                      int cells_per_px);

/// The cells of a raster that a quarter of a quadtree leaf covers: [x, x + n) x [y, y + n). If the quarter is
/// smaller than a cell, n is 1, and `share` is the fraction of the cell's area that the quarter covers.
struct QuarterCells {
    int x = 0, y = 0, n = 1;
    float share = 1;
};
[[nodiscard]] QuarterCells quarter_cells(const PointSample& leaf_at, float leaf_size, std::size_t corner,
                                         int cells_per_px);

/// Returns the nearest surface of group g (objects that move alike) at a sample, or nullptr if there is none.
[[nodiscard]] const LayerSurface* surface_of(const BandSurfaces& band, std::uint32_t sample,
                                             const GroupTable& table, int g);

/// Calls on_leaf(leaf, surfaces) for each quadtree leaf in `window` that shows an object of group g (objects
/// that move alike). surfaces[k] is the nearest surface of the group at the leaf's corner k, or nullptr if
/// there is none.
template <typename OnLeaf>
void for_each_leaf_of(const BandSurfaces& band, const GroupTable& table, int g, const CellWindow& window,
                      int cells_per_px, const OnLeaf& on_leaf) {
    const int y_begin = std::max(window.y_begin / cells_per_px, band.y_begin),
              y_end = std::min(window.y_end / cells_per_px, band.y_end);
    for (int y = y_begin; y < y_end; ++y) {
        for (int x = window.x_begin / cells_per_px; x < window.x_end / cells_per_px; ++x) {
            band.for_each_leaf(x, y, [&](const Leaf& leaf) {
                std::array<const LayerSurface*, 4> s{};
                for (std::size_t k = 0; k < 4; ++k) s[k] = surface_of(band, leaf.corner[k], table, g);
                if (s != std::array<const LayerSurface*, 4>{}) on_leaf(leaf, s);
            });
        }
    }
}

/// Draws an image of the moving group g at the recorded instant, as a raster of square cells. A cell is
/// 1/cells_per_px px wide. It shows the group's nearest recorded surface, even if an object outside the group
/// hides this surface.
[[nodiscard]] Planes draw_group(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                                const MovingGroup& group, int cells_per_px);

/// Converts a raster of square cells to pixels. Each pixel is the mean of its `cells_per_px` x `cells_per_px`
/// cells.
[[nodiscard]] GroupPicture in_pixels(const Planes& cells, int cells_per_px, int width, int height);

}  // namespace postlens
