// A moving group with parallax, cut by depth: i1 of each slice, which goes a path of its own.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "motionblur/band_surfaces.h"
#include "motionblur/convolution.h"

namespace postlens {

/// More slices are not made; the steps between them grow then.
inline constexpr int most_slices = 64;
/// How many slices a group with parallax gets, 2..most_slices.
[[nodiscard]] int slices_for(const MovingGroup& group);

/// Parts of one group that lie behind one another: the area, px^2, that the motion uncovers between them or
/// lays over each other at most, as a share of the group's recorded area. Steps in depth that come apart by
/// less than half a pixel do not count. DepthSlices takes such parts for one opaque surface.
[[nodiscard]] double torn_share(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                                const MovingGroup& group, double across_per_px);

/// A direction in which the group's path goes, and how far: of path . direction, px.
struct PathAxis {
    glm::dvec2 direction{1, 0};
    double low_px = 0, high_px = 0;
};

/// The directions in which the path strays by more than 1 px: of its farthest point, and across.
[[nodiscard]] std::vector<PathAxis> axes_of(const MovingGroup& group);

/// How a surface's area changes on its way. What lies at 1/z' goes by path(t) * (1/z') / path_inverse_z, so a
/// piece of a surface on which 1/z' has the gradient G per px has, at t, 1 + sum of rate * (path(t) . axis)
/// times its recorded area, with the rates G . axis / path_inverse_z, 1/px: exact for a translation parallel
/// to the film. A piece that turns over on the way has it for the part of the way on which it has not:
/// `area` and the rates are then those of a line that falls to 0 at the way's end and holds as much light.
struct Stretch {
    double area = 1;
    glm::dvec2 rate_per_px{0};
};
[[nodiscard]] Stretch stretch_of(const glm::dvec2& rate_per_px, const std::vector<PathAxis>& axes);

/// r, g, b and coverage of a slice. At t it is the sum of `flat` and of `stretched[a]` times (path(t) . axis
/// a
/// - low_px of a).
struct SliceRaster {
    Planes flat;
    std::vector<Planes> stretched;  ///< by axis; empty where nothing is stretched
};

/// Slices at evenly spaced inverse depths from the farthest to the nearest; a surface between two of them is
/// in both, by how near it is to either, so that they add up to the group everywhere.
class DepthSlices {
  public:
    /// Of group g, which has parallax. `across_per_px`: of the film (sample_surfaces.h).
    DepthSlices(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                const MovingGroup& group, int cells_per_px, double across_per_px);

    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] const std::vector<PathAxis>& axes() const { return axes_; }
    /// What the group's path is multiplied by for slice k.
    [[nodiscard]] double path_scale(int k) const;
    [[nodiscard]] SliceRaster draw(int k) const;
    /// Where the group was recorded: the cells of every slice.
    [[nodiscard]] const CellWindow& window() const { return window_; }

  private:
    /// A corner's quarter of a leaf.
    struct Piece {
        int x = 0, y = 0, n = 1, slice = 0;
        float share = 0, r = 0, g = 0, b = 0;
        float nearer = 0;  ///< 0..1: from its slice to the next
        float area = 1;    ///< Stretch::area, with the rates' part up to the axes' low ends
        std::array<float, 2> rate{};
    };
    struct BandPieces {
        std::vector<Piece> pieces;
        std::vector<std::uint32_t> order;  ///< slice by slice: indices into pieces
        std::vector<std::size_t> offsets;  ///< by slice: its first in `order`
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
