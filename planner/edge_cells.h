// What the corners of the quadtree's cells tell of the edges that cross them.
#pragma once

#include <array>
#include <cstdint>

#include "lens/focus_geometry.h"
#include "records/quadtree.h"
#include "records/record.h"

namespace postlens {

/// Mean squared error of the share that a straight edge of any direction and place, which parts the corners
/// of a square, takes of it, when the share is taken to be that of the corners: 200,000 random edges give
/// 0.0388.
inline constexpr double edge_cell_variance = 0.0388;
/// The same of an edge along a side of the square: anywhere in it with equal chance.
inline constexpr double aligned_cell_variance = 1.0 / 12;

/// A corner's colour, encoded, with what else is wanted of it.
struct CellCorner {
    std::array<float, 3> encoded{}, linear{};
    std::uint32_t id = 0;  ///< of the primary node
    double inverse_z = 0;  ///< of the primary node, 1/m
};
[[nodiscard]] CellCorner cell_corner(const RecordBand& band, const PointSample& sample);

struct CellStep {
    /// none: as good as even. upright, level: two corners at one side against two, so that the edge may run
    /// along the cells; slanted: one corner against three, or two opposite ones.
    enum class Split { none, upright, level, slanted };
    Split split = Split::none;
    double square = 0;  ///< of the step, mean of the channels
    bool same_id = true;
    double curvature_square = 0;  ///< of the corners' mixed difference, mean of the channels
    /// Scene-linear, of the channel with the highest corner: that corner and the lowest one.
    double high = 0, low = 0;
};

/// Light above 1 of some cells, which a circle of confusion spreads: encoding clips it in the cells
/// themselves, but not what is left of it out there.
class SpreadLight {
  public:
    void add(const std::array<const CellCorner*, 4>& corners, const CellStep& step, double size_px,
             const FocusGeometry& geometry);
    /// The squared error, summed over pixels and encoded, of knowing the cells' edges by their corners.
    /// `variance_share`: as if that of the light were so much of what it is.
    [[nodiscard]] double error(double variance_share = 1) const;

  private:
    double area_ = 0;      ///< px^2
    double light_ = 0;     ///< radiance times px^2, brightest channel
    double variance_ = 0;  ///< of that
    double ground_ = 1;    ///< radiance beside it
    double coc_px_ = 0;    ///< of the brightest
    double brightest_ = 1;
};
/// Corners up-left, up-right, down-left, down-right.
[[nodiscard]] CellStep cell_step(const std::array<const CellCorner*, 4>& corners);

/// The expected squared error of a pixel from the steps of its cells. An edge that runs along the cells of a
/// pixel is off by the same way in all of them, and their errors add up; where it slants, they hardly do.
class PixelEdges {
  public:
    void add(const CellStep& step, double size_px);
    [[nodiscard]] bool aligned() const { return slanted_ == 0; }
    [[nodiscard]] double mse() const;

  private:
    double upright_ = 0, level_ = 0;  ///< sums of area times step
    double independent_ = 0;          ///< of cells without an edge, or across one that slants
    double sum_ = 0;                  ///< area^2 step^2 of all cells with an edge
    int slanted_ = 0;
};

}  // namespace postlens
