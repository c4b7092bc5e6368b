// Estimates the error that edges cause because their exact positions are unknown: colours are recorded only
// at the corners of quadtree cells.
#pragma once

#include <array>
#include <cstdint>

#include "lens/focus_geometry.h"
#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// An edge at a random position and angle divides a unit square into two parts. The area of one part is
/// estimated by the fraction of the square's four corners that lie in this part. This constant is the mean
/// squared error of the estimate.
inline constexpr double edge_cell_variance = 0.0388;
/// Like `edge_cell_variance`, but for an edge that is parallel to two sides of the unit square and lies at a
/// random position.
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
    /// Colours of the brightest channel at the cell's four corners, scene-linear. `high` is the largest value
    /// that any colour channel has at any corner. `low` is the smallest value of the same channel at the four
    /// corners.
    double high = 0, low = 0;
};

/// Estimates an error that bright light causes. If an edge crosses a quadtree cell with a radiance above 1,
/// the amount of the cell's light is uncertain. The lens spreads this light over many pixels, so all of them
/// are wrong. The class PixelEdges, which estimates the error of a single pixel, does not include this error.
class SpreadLight {
  public:
    void add(const std::array<const CellCorner*, 4>& corners, const CellStep& step, double size_px,
             const FocusGeometry& geometry);
    /// Returns the squared error of sRGB values that the cells passed to add() cause, as a sum over all
    /// pixels to which the lens spreads their light. The amount of this light is uncertain, with a certain
    /// variance. `variance_share` multiplies this variance, for example to predict the error with cells of
    /// another size.
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

/// Estimates the squared error of a pixel's sRGB value. The error arises because edges cross the pixel's
/// quadtree cells at unknown positions. If an edge is parallel to the sides of the cells, it crosses all of
/// them at the same position, so their errors are equal and add up. If an edge is slanted, the errors of the
/// cells are independent and partly cancel.
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
