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

/// Returns the direction from a group's recorded position to the farthest point of its motion path. If the
/// path leaves this line by over 1 px, also returns the perpendicular direction. The result is empty if the
/// group does not move.
[[nodiscard]] std::vector<PathAxis> axes_of(const MovingGroup& group);

/// How the projected area of a small piece of surface changes while it moves. Relative to the recorded area,
/// it is
///
///     area + sum over the axes of rate * (path(t) . axis)
///
/// Here path(t) is the displacement at time t, in px, and the axes are the directions of axes_of. This is
/// exact for translations parallel to the film, unless the piece turns its back to the camera. Then only the
/// mean of its area is correct.
struct Stretch {
    double area = 1;
    /// Relative change of the area per px of displacement, for each axis of the motion path: G . axis /
    /// path_inverse_z. G is the gradient of the surface's inverse depth 1/z' per px. path_inverse_z is the
    /// inverse depth of the points that follow the path exactly.
    glm::dvec2 rate_per_px{0};
};
[[nodiscard]] Stretch stretch_of(const glm::dvec2& rate_per_px, const std::vector<PathAxis>& axes);

/// Red, green, blue and coverage of a depth slice while the object is displaced by p. They are linear in p:
///
///     flat + sum over the axes a of stretched[a] * (dot(p, a.direction) - a.low_px)
///
/// The axes are the one or two directions along which the object moves (PathAxis).
struct SliceRaster {
    Planes flat;
    std::vector<Planes> stretched;  ///< one per axis
};

/// Slices at uniformly spaced inverse depths, from far to near. A surface between two slices is drawn into
/// both, with weights that sum to 1.
class DepthSlices {
  public:
    /// Divides a group of moving objects with parallax into depth slices. `across_per_px` is the width, in m,
    /// that a pixel covers in the scene. For a perspective camera, it is the width at a depth of 1 m.
    DepthSlices(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                const MovingGroup& group, int cells_per_px, double across_per_px);

    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] const std::vector<PathAxis>& axes() const { return axes_; }
    /// Returns the length of depth slice k's motion path relative to the group's path. Nearer slices have
    /// longer paths (parallax).
    [[nodiscard]] double path_scale(int k) const;
    [[nodiscard]] SliceRaster draw(int k) const;
    /// Raster cells that the moving objects cover at the recorded instant. All depth slices use this window.
    [[nodiscard]] const CellWindow& window() const { return window_; }

  private:
    /// One quarter of a quadtree cell (a pixel or a part of it), in the colour of the sample at the nearest
    /// corner.
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
