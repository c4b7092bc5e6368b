// The error that arises because edges are known only from the corners of quadtree cells.
#pragma once

#include <array>
#include <cstdint>

#include "lens/focus_geometry.h"
#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Mean squared error of an estimated area. A straight edge divides a square; the share of the square's
/// corners on one side of the edge estimates the share of its area on that side. The mean is over 200,000
/// random edges that separate corners.
inline constexpr double edge_cell_variance = 0.0388;
/// Mean squared error of the estimate of an area by the corners of a square, for an edge that is parallel to
/// a side of the square and has a uniformly distributed position.
inline constexpr double aligned_cell_variance = 1.0 / 12;

/// Colour (sRGB and linear), id and depth at a corner of a cell.
struct CellCorner {
    std::array<float, 3> encoded{}, linear{};
    std::uint32_t id = 0;  ///< id of the primary node
    double inverse_z = 0;  ///< inverse depth of the primary node, 1/m
};
[[nodiscard]] CellCorner cell_corner(const RecordBand& band, const PointSample& sample);

struct CellStep {
    /// Which corners of the cell are separated by the edge. none: there is no edge, and the cell is nearly
    /// uniform. upright, level: two adjacent corners from the other two, so the edge may be parallel to a
    /// side. slanted: one corner from three, or two opposite corners from the other two.
    enum class Split { none, upright, level, slanted };
    Split split = Split::none;
    double square = 0;  ///< squared height of the step, mean over channels
    bool same_id = true;
    double curvature_square = 0;  ///< square of the corners' mixed second difference, mean over channels
    /// Largest and smallest scene-linear value of the channel that has the brightest corner.
    double high = 0, low = 0;
};

/// The radiance above 1 of some cells, and the error that it causes in the pixels over which the circle of
/// confusion spreads it. sRGB encoding clips this radiance in the cells themselves, but not in the pixels
/// over which it is spread.
class SpreadLight {
  public:
    void add(const std::array<const CellCorner*, 4>& corners, const CellStep& step, double size_px,
             const FocusGeometry& geometry);
    /// Squared error, of sRGB values and summed over pixels. It arises because the edges in the cells are
    /// known only from the cells' corners. The variance of the radiance is multiplied by `variance_share`.
    [[nodiscard]] double error(double variance_share = 1) const;

  private:
    double area_ = 0;      ///< px^2
    double light_ = 0;     ///< radiance times px^2, brightest channel
    double variance_ = 0;  ///< variance of light_
    double ground_ = 1;    ///< radiance beside the cells
    double coc_px_ = 0;    ///< CoC diameter of the brightest corner
    double brightest_ = 1;
};
/// Returns how the colour differs between the four corners of a cell. The order of the corners is up-left,
/// up-right, down-left, down-right.
[[nodiscard]] CellStep cell_step(const std::array<const CellCorner*, 4>& corners);

/// Expected squared error of a pixel, from the differences between the corners of its cells. For an edge that
/// is parallel to the cells' sides, all cells have the same error, and the errors add up. For a slanted edge,
/// the errors of the cells are nearly independent.
class PixelEdges {
  public:
    void add(const CellStep& step, double size_px);
    [[nodiscard]] bool aligned() const { return slanted_ == 0; }
    [[nodiscard]] double mse() const;

  private:
    double upright_ = 0, level_ = 0;  ///< sums of area times step
    double independent_ = 0;          ///< squared error of the cells without an edge
    double sum_ = 0;                  ///< sum of area^2 step^2 over the cells with an edge
    int slanted_ = 0;
};

}  // namespace postlens
