// Divides a group of moving objects into depth slices. Each slice has its own motion path, because near
// surfaces move farther in the image than distant surfaces (parallax).
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

/// Returns the error of drawing a group of moving objects as one opaque surface. It is the area of the gaps
/// and overlaps that arise because near parts move farther than distant parts, as a fraction of the group's
/// area in the recorded image. Gaps below 0.5 px do not count.
[[nodiscard]] double torn_share(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                                const MovingGroup& group, double across_per_px);

/// A direction in the image, as a unit vector, and the range of the displacements of a group of moving
/// objects along this direction, in px.
struct PathAxis {
    glm::dvec2 direction{1, 0};
    double low_px = 0, high_px = 0;
};

/// Returns the main axis of a moving group's motion path. It points from the group's position in the image at
/// the recorded instant to the farthest point of the path. If the path is curved, the axis perpendicular to
/// it is returned as well.
[[nodiscard]] std::vector<PathAxis> axes_of(const MovingGroup& group);

/// How the area of a small surface element in the image changes when its object moves. If the element is
/// displaced by d, in px, from its recorded position in the image, its recorded area is multiplied by
///
///     area + sum over the axes a of rate_per_px[a] * dot(d, a.direction)
///
/// The axes are directions of the motion in the image (PathAxis). The formula is exact for translations
/// parallel to the film.
struct Stretch {
    double area = 1;
    /// For each axis a of the object's motion: rate_per_px[a] is the change of the surface element's area, as
    /// a fraction of its recorded area, per px of displacement along this axis.
    glm::dvec2 rate_per_px{0};
};
[[nodiscard]] Stretch stretch_of(const glm::dvec2& rate_per_px, const std::vector<PathAxis>& axes);

/// Image (colours and coverage) of one depth slice of a group of moving objects. The slice moves as a whole,
/// but the areas of its surfaces in the image change linearly with the displacement (Stretch). So its colours
/// and coverage change linearly, too. At the displacement p, in px, the image is
///
///     flat + sum over the axes a (PathAxis) of stretched[a] * (dot(p, a.direction) - a.low_px)
///
/// a.low_px is the smallest displacement along the axis a. `flat` is the image at the smallest displacements,
/// and `stretched` is its change per px along each axis.
struct SliceRaster {
    Planes flat;
    std::vector<Planes> stretched;  ///< one per axis
};

/// A group of moving objects, divided into slices by depth. The slices lie at uniformly spaced inverse
/// depths, from far to near. A surface between two slices is drawn into both, with weights that sum to 1.
class DepthSlices {
  public:
    /// Sorts the surfaces of `group`, a group of moving objects, into slices by depth.
    /// - `table`: maps the objects of `group` to the number `g`
    /// - `cells_per_px`: resolution of the images of slices that `draw` returns
    /// - `across_per_px`: width of a pixel in the scene, in m; for a perspective camera, at a depth of 1 m
    DepthSlices(const std::vector<BandSurfaces>& bands, const GroupTable& table, int g,
                const MovingGroup& group, int cells_per_px, double across_per_px);

    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] const std::vector<PathAxis>& axes() const { return axes_; }
    /// Returns the factor by which MovingGroup::path is multiplied for depth slice k. The path contains the
    /// group's displacements in the image, in px, at only one inverse depth, `path_inverse_z`. Because of
    /// parallax, nearer slices move farther, so their factor is larger.
    [[nodiscard]] double path_scale(int k) const;
    [[nodiscard]] SliceRaster draw(int k) const;
    [[nodiscard]] const CellWindow& window() const { return window_; }

  private:
    /// A quarter of a quadtree leaf, with the colour (r, g, b) of the sample at its corner. It covers the
    /// cells [x, x + n) x [y, y + n) of the image of the depth slice with the number `slice`.
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
