// Divides a moving group of objects with parallax into depth slices, each with its own path.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "motionblur/convolution/convolution.h"
#include "motionblur/groups/band_surfaces.h"

namespace postlens {

/// Largest number of depth slices. Larger parallax increases their spacing.
inline constexpr int most_slices = 64;
/// Returns the number of slices of a group with parallax, 2..most_slices.
[[nodiscard]] int slices_for(const MovingGroup& group);

/// Returns the error of drawing a group of moving objects as one opaque surface. Parts at different depths
/// move differently, so gaps and overlaps arise between them. The error is the area of these gaps and
/// overlaps relative to the recorded area of the group. Gaps below 0.5 px do not count.
[[nodiscard]] double torn_share(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                                const MovingGroup& group, double across_per_px);

/// A direction in the image, and the range over which a group of objects moves along it.
struct PathAxis {
    glm::dvec2 direction{1, 0};
    double low_px = 0, high_px = 0;
};

/// Returns the direction to the farthest point of the group's motion path. For a curved path, also returns
/// the perpendicular direction.
[[nodiscard]] std::vector<PathAxis> axes_of(const MovingGroup& group);

/// Projected area of a small surface element while it moves, relative to its recorded area:
///
///     area + sum over the axes of rate_per_px * (path(t) . axis)
///
/// path(t) is the displacement, in px. The formula is exact for translations parallel to the film.
struct Stretch {
    double area = 1;
    /// Relative change of the projected area per px of displacement along each axis.
    glm::dvec2 rate_per_px{0};
};
[[nodiscard]] Stretch stretch_of(const glm::dvec2& rate_per_px, const std::vector<PathAxis>& axes);

/// Colours and coverage of a depth slice (surfaces at similar depths) that is displaced by p, in px:
///
///     flat + sum over the axes a (PathAxis) of stretched[a] * (dot(p, a.direction) - a.low_px)
struct SliceRaster {
    Planes flat;
    std::vector<Planes> stretched;  ///< one per axis
};

/// Slices at uniformly spaced inverse depths, from far to near. A surface between two slices is drawn into
/// both, with weights that sum to 1.
class DepthSlices {
  public:
    /// Sorts the surfaces of `group`, which has the number `g`, into depth slices (surfaces at similar
    /// depths).
    /// - `across_per_px`: width of a pixel in the scene, in m; for perspective cameras, at a depth of 1 m
    DepthSlices(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                const MovingGroup& group, int cells_per_px, double across_per_px);

    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] const std::vector<PathAxis>& axes() const { return axes_; }
    /// Returns how far depth slice k moves, relative to the motion path of the whole group; nearer slices
    /// move farther.
    [[nodiscard]] double path_scale(int k) const;
    [[nodiscard]] SliceRaster draw(int k) const;
    [[nodiscard]] const CellWindow& window() const { return window_; }

  private:
    /// One quarter of a quadtree cell (a pixel or a part of it), with the colour of the nearest recorded
    /// sample.
    struct Piece {
        int x = 0, y = 0, n = 1, slice = 0;
        float share = 0, r = 0, g = 0, b = 0;
        float nearer = 0;  ///< from 0 to 1: depth between its slice and the next nearer one
        float area = 1;    ///< Stretch::area plus, for each axis, the rate times low_px
        std::array<float, 2> rate{};
    };
    struct BandPieces {
        std::vector<Piece> pieces;
        std::vector<std::uint32_t> order;  ///< indices into pieces, sorted by slice
        std::vector<std::size_t> offsets;  ///< for each slice, its first entry in `order`
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
