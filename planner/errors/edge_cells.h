// Estimates the error at edges in an image that is made from a sample file. Colours are recorded only at the
// corners of quadtree cells. So it is known that an edge crosses a cell, but not where.
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
/// Mean squared error of an estimated area, like `edge_cell_variance`: an edge divides a unit square, and the
/// area of one part is estimated from the square's corners. Here, the edge is parallel to two sides of the
/// square and lies at a random position.
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
    /// - `none`: not at all, because there is no edge
    /// - `upright`: the two left corners from the two right ones, as a vertical edge does
    /// - `level`: the two upper corners from the two lower ones, as a horizontal edge does
    /// - `slanted`: in any other way, so the edge is not parallel to a side
    enum class Split { none, upright, level, slanted };
    Split split = Split::none;
    double square = 0;  ///< squared height of the step, mean over channels
    bool same_id = true;
    double curvature_square = 0;  ///< square of the corners' mixed second difference, as a mean over channels
    /// Range of the brightest colour channel over the cell's four corners, scene-linear. The brightest
    /// channel is the one that contains the largest value of all corners and channels. `high` is this value.
    /// `low` is the smallest value of the same channel.
    double high = 0, low = 0;
};

/// Estimates an error of bright light. If an edge crosses a quadtree cell with a radiance above 1, the amount
/// of the cell's light is uncertain, because the position of the edge is unknown. The lens spreads this error
/// over many pixels.
class SpreadLight {
  public:
    void add(const std::array<const CellCorner*, 4>& corners, const CellStep& step, double size_px,
             const FocusGeometry& geometry);
    /// Returns the squared error of sRGB values that the cells passed to add() cause, as a sum over all
    /// pixels to which the lens spreads their light. The variance of the amount of light is multiplied by
    /// `variance_share`, for example to predict the error with smaller cells.
    [[nodiscard]] double error(double variance_share = 1) const;

  private:
    double area_ = 0;      ///< px^2
    double light_ = 0;     ///< radiance times px^2, brightest channel
    double variance_ = 0;  ///< variance of light_
    double ground_ = 1;    ///< radiance beside the cells
    double coc_px_ = 0;    ///< CoC diameter of the brightest corner
    double brightest_ = 1;
};
/// Describes the edge that crosses a quadtree cell, from the colours at the cell's corners: its contrast, and
/// which corners lie on the same side of it. Order of the corners: upper left, upper right, lower left, lower
/// right.
[[nodiscard]] CellStep cell_step(const std::array<const CellCorner*, 4>& corners);

/// Estimates the squared error of a pixel's sRGB value that arises at edges. An edge crosses some quadtree
/// cells of the pixel at unknown positions, so the colours of these cells have errors.
class PixelEdges {
  public:
    void add(const CellStep& step, double size_px);
    /// Returns whether the edge is parallel to a side of the cells. If it is, it divides all of them in the
    /// same ratio, so their errors are equal and add up. Otherwise, the errors are independent and partly
    /// cancel.
    [[nodiscard]] bool aligned() const { return slanted_ == 0; }
    [[nodiscard]] double mse() const;

  private:
    double upright_ = 0, level_ = 0;  ///< sums of area times step
    double independent_ = 0;          ///< squared error of the cells without an edge
    double sum_ = 0;                  ///< sum of area^2 step^2 over the cells with an edge
    int slanted_ = 0;
};

}  // namespace postlens
