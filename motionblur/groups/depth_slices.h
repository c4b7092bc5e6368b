// Cuts a moving group of objects with parallax into slices by depth. Each slice has its own raster and moves
// on its own path.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "motionblur/convolution/convolution.h"
#include "motionblur/groups/band_surfaces.h"

namespace postlens {

/// Largest number of slices. With more parallax the slices lie farther apart.
inline constexpr int most_slices = 64;
/// Number of slices of a group with parallax, 2..most_slices.
[[nodiscard]] int slices_for(const MovingGroup& group);

/// Parts of a group at different depths move differently: areas between them are uncovered, and the parts
/// come to overlap. The result is the largest such area, as a share of the group's recorded area. Depth steps
/// whose sides separate by less than 0.5 px do not count. DepthSlices treats all parts as one opaque surface,
/// so it is in error over this area.
[[nodiscard]] double torn_share(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                                const MovingGroup& group, double across_per_px);

/// A direction along which a moving group's path extends, with the range of the path along it: the least and
/// the greatest scalar product of path and direction, px.
struct PathAxis {
    glm::dvec2 direction{1, 0};
    double low_px = 0, high_px = 0;
};

/// The direction of the path's farthest point and, if the path leaves that line by more than 1 px, the
/// direction perpendicular to it. Empty if the path does not move.
[[nodiscard]] std::vector<PathAxis> axes_of(const MovingGroup& group);

/// Change of a surface's projected area along its path. A point at 1/z' moves by path(t) * (1/z') /
/// path_inverse_z. At time t, a piece of surface on which 1/z' has the gradient G per px therefore has 1 +
/// sum over the axes of rate * (path(t) . axis) times its recorded area, with rate = G . axis /
/// path_inverse_z, 1/px. This is exact for a translation parallel to the film. If this area becomes negative,
/// the piece has turned over and is no longer drawn. `area` and the rates then describe a linear function
/// that falls to 0 at the end of the path and has the same integral as the positive part.
struct Stretch {
    double area = 1;
    glm::dvec2 rate_per_px{0};
};
[[nodiscard]] Stretch stretch_of(const glm::dvec2& rate_per_px, const std::vector<PathAxis>& axes);

/// r, g, b and coverage of a depth slice, linear in its position along the axes of the path. At time t the
/// slice is `flat` plus the sum over the axes a of stretched[a] * (path(t) . direction of a - low_px of a).
struct SliceRaster {
    Planes flat;
    std::vector<Planes> stretched;  ///< one per axis
};

/// Slices at evenly spaced inverse depths, from the farthest to the nearest. A surface between two slices is
/// drawn into both with linear weights, so that the slices add up to the group everywhere.
class DepthSlices {
  public:
    /// Slices of group g, which must have parallax. `across_per_px`: size of a pixel on the film
    /// (sample_surfaces.h).
    DepthSlices(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                const MovingGroup& group, int cells_per_px, double across_per_px);

    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] const std::vector<PathAxis>& axes() const { return axes_; }
    /// Factor by which the path of the whole group is multiplied to give the path of slice k.
    [[nodiscard]] double path_scale(int k) const;
    [[nodiscard]] SliceRaster draw(int k) const;
    /// The window that all slices have: the cells that contain the group at the recorded instant.
    [[nodiscard]] const CellWindow& window() const { return window_; }

  private:
    /// The quarter of a leaf at one of its corners.
    struct Piece {
        int x = 0, y = 0, n = 1, slice = 0;
        float share = 0, r = 0, g = 0, b = 0;
        float nearer = 0;  ///< 0..1: position between its slice and the next nearer one
        float area = 1;    ///< Stretch::area plus the rates times low_px of their axes
        std::array<float, 2> rate{};
    };
    struct BandPieces {
        std::vector<Piece> pieces;
        std::vector<std::uint32_t> order;  ///< indices into pieces, sorted by slice
        std::vector<std::size_t> offsets;  ///< per slice, its first entry in `order`
    };

    void collect(const BandSurfaces& band, const GroupTable& table, int g, BandPieces& out) const;
    [[nodiscard]] Stretch leaf_stretch(const Leaf& leaf, const std::array<const LayerSurface*, 4>& s) const;

    int count_ = 2, cells_per_px_ = 1;
    double far_ = 0, step_ = 0, path_inverse_z_ = 0, across_per_px_ = 0;
    CellWindow window_;
    std::vector<PathAxis> axes_;
    std::vector<BandPieces> bands_;
};

}  // namespace postlens
