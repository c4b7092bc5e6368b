// Draws the motion path of an object into a raster, the kernel that blurs the object's image by convolution
// (i2 in [potmesil1983]). Each cell stands for a displacement of the object, and contains the fraction of the
// exposure's light that arrives while the object has this displacement.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lens/shutter_curve.h"
#include "motionblur/paths/screen_path.h"

namespace postlens {

/// Cells [x_begin, x_end) x [y_begin, y_end) of a raster of cells.
struct CellWindow {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    [[nodiscard]] int width() const { return x_end - x_begin; }
    [[nodiscard]] int height() const { return y_end - y_begin; }
};

struct PathRaster {
    int x_begin = 0, y_begin = 0, width = 0, height = 0;
    int cells_per_px = 1;
    std::vector<double> weight;  ///< row by row

    /// Returns the value of the raster cell (x, y) that draw_path computed. The cell must lie in the raster.
    [[nodiscard]] double at(int x, int y) const {
        return weight[static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x - x_begin)];
    }
};

/// Limits for draw_path(), which draws a motion path into a raster of square cells. They bound its memory and
/// time. `most_path_cells` is the largest width or height of the raster, in cells. `most_path_crossings` is
/// the largest number of cell borders that the path may cross.
inline constexpr double most_path_cells = 1'000'000;
inline constexpr double most_path_crossings = 200'000'000;

/// Draws the raster of a path. Cell (i, j) contains the share of the shutter's light that arrives while the
/// displacement lies in [i - 1/2, i + 1/2) x [j - 1/2, j + 1/2). The displacement is (path - `origin_px`) *
/// cells_per_px, with cells_per_px >= 1. The weights of all cells sum to 1. The path does not move before its
/// first and after its last point. If open_s == close_s, there is one cell of weight 1.
///
/// The result is exact for pieces of constant velocity. Each piece is cut at the borders of cells. The weight
/// of a part is the light that the shutter transmits between the two ends of the part.
///
/// With `keep`, only the cells in this window are computed, and the weights sum to the share of the light in
/// them. The raster is empty if no light arrives there. The computing time is at most proportional to the
/// number of points times the sum of the window's width and height.
///
/// `values` contains one value per point, and is linear in time between the points. With `values`, each cell
/// contains the integral of the value over the cell's light, instead of the light.
///
/// Throws Error(wrong_arguments) for times out of order, for no points, and for positions that are not finite
/// or more than 1e13 cells away. Throws the same error if, after clipping to `keep`, a side of the raster
/// exceeds `most_path_cells` or the path has more crossings than `most_path_crossings`. Throws
/// Error(out_of_memory) if the raster does not fit into memory.
[[nodiscard]] PathRaster draw_path(std::span<const PathPoint> points, glm::dvec2 origin_px, double open_s,
                                   double close_s, const ShutterCurve& curve, int cells_per_px,
                                   const std::optional<CellWindow>& keep = std::nullopt,
                                   std::span<const double> values = {});

}  // namespace postlens
