// Estimates the error that edges cause because their exact positions are unknown: colours are recorded only
// at the corners of quadtree cells.
#pragma once

#include <array>
#include <cstdint>

#include "lens/focus_geometry.h"
#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Mean squared error of an estimated area. A random straight edge divides a unit square; the fraction of the
/// four corners on one side of the edge estimates the area of this part.
inline constexpr double edge_cell_variance = 0.0388;
/// Mean squared error of an estimated area. An edge parallel to two sides of a unit square divides it at a
/// random position; the fraction of the four corners beyond the edge estimates the area there.
inline constexpr double aligned_cell_variance = 1.0 / 12;

/// The recorded colour (sRGB and linear) at a corner of a quadtree cell, with the id and inverse depth of the
/// surface there.
struct CellCorner {
    std::array<float, 3> encoded{}, linear{};
    std::uint32_t id = 0;  ///< id of the primary node
    double inverse_z = 0;  ///< inverse depth of the primary node, 1/m
};
[[nodiscard]] CellCorner cell_corner(const RecordBand& band, const PointSample& sample);

struct CellStep {
    /// How an edge separates the four corners of a square cell:
    /// - `none`: there is no edge
    /// - `upright`, `level`: it separates two adjacent corners from the other two, so it may be parallel to a
    ///   side
    /// - `slanted`: it separates one corner from the other three, or two opposite corners from the other two
    enum class Split { none, upright, level, slanted };
    Split split = Split::none;
    double square = 0;  ///< squared height of the step, mean over channels
    bool same_id = true;
    double curvature_square = 0;  ///< square of the corners' mixed second difference, as a mean over channels
    /// `high` is the largest scene-linear value of any colour channel at the cell's four corners. `low` is
    /// the smallest value of the same channel there.
    double high = 0, low = 0;
};

/// If an edge crosses a bright quadtree cell (radiance above 1), the cell's light is inexact. Estimates the
/// error of all pixels over which the lens spreads it. PixelEdges does not include it.
class SpreadLight {
  public:
    void add(const std::array<const CellCorner*, 4>& corners, const CellStep& step, double size_px,
             const FocusGeometry& geometry);
    /// Returns the squared error of sRGB values, summed over all pixels to which the lens spreads the light
    /// of the added cells. Larger or smaller cells change the variance of this light by the factor
    /// `variance_share`.
    [[nodiscard]] double error(double variance_share = 1) const;

  private:
    double area_ = 0;      ///< px^2
    double light_ = 0;     ///< radiance times px^2, brightest channel
    double variance_ = 0;  ///< variance of light_
    double ground_ = 1;    ///< radiance beside the cells
    double coc_px_ = 0;    ///< CoC diameter of the brightest corner
    double brightest_ = 1;
};
/// Returns the contrast of an edge that crosses a quadtree cell, and which corners lie on the same side of
/// it. Order of the corners: upper left, upper right, lower left, lower right.
[[nodiscard]] CellStep cell_step(const std::array<const CellCorner*, 4>& corners);

/// Estimates the squared error of a pixel that arises because edges cross its quadtree cells at unknown
/// positions. The cells' errors are equal along an edge parallel to their sides, and independent along a
/// slanted edge.
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
