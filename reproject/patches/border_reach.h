// Finds the pixels of a view (image for one lens point and instant) that may show a surface from outside the
// recorded image.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "reproject/patch_field.h"
#include "reproject/patches/time_spans.h"

namespace postlens {

/// Finds pixels in which a view (image for one lens point and instant) may show a surface from outside the
/// recorded image. At each border pixel, the nearest surface is assumed to continue beyond the border.
class BorderReach {
  public:
    /// `instant` is the index of the recorded instant of `primary`.
    BorderReach(const PatchMesh& primary, const PatchField& field, std::size_t instant);
    /// Returns whether the lens or motion may bring a surface from beyond the border of the recorded image
    /// into the tile `at`.
    [[nodiscard]] bool reaches(const TilePlace& at) const;
    /// Finds the pixels of `view` (image for another lens point or instant) that surfaces from outside the
    /// recorded image may cover. Each surface at the border is assumed to continue beyond it.
    /// SeenTile::maybe_inverse_z receives the inverse depth of the nearest one in each pixel.
    void mark(const PatchView& view, const PatchView::Use& use, const TilePlace& at, SeenTile& seen) const;

  private:
    struct Cell {
        float inverse_z = 0;
        std::size_t motion_class = 0;
        bool any = false;
    };
    /// Computes how far the lens can displace the image of a surface point from its position in the pinhole
    /// image: an upper bound, in px, for all lens points passed to `add`.
    struct LensReach {
        glm::dvec2 lens_px{0}, offset_px{0};
        double nearest_focus_per_m = 0, farthest_focus_per_m = std::numeric_limits<double>::infinity();
        void add(const LensShift& view);
        [[nodiscard]] glm::dvec2 px(double inverse_z) const;
    };
    /// One side of the raster.
    struct Side {
        bool across = false;  ///< whether this is the left or right side
        bool after = false;   ///< whether this is the right or bottom side
        int first = 0;        ///< position of the first cell along the side, raster px
        double at = 0;        ///< raster px of the side itself
        std::vector<Cell> cells;
        /// Largest displacement of a surface at this side of the recorded image, between its recorded
        /// position and its position in any view. `deepest_px` is the component towards the inside of the
        /// image, perpendicular to the side. `sideways_px` is the component along the side.
        double deepest_px = 0, sideways_px = 0;
        void widen(const glm::dvec2& moved_px, const glm::dvec2& around_px);
        void widen(const TimeSpanViews& span, const LensReach& lens);
        [[nodiscard]] bool reaches(const TilePlace& tile) const;
    };
    /// Position at which a view shows a border pixel of the recorded image. `along` is the raster coordinate
    /// parallel to the border, and `across` the one perpendicular to it, in px. `inverse_z` is in 1/m. `any`
    /// is false if the pixel has no surface, or if this lies behind the camera at the view's instant.
    struct Seen {
        double along = 0, across = 0, inverse_z = 0;
        bool any = false;
    };
    [[nodiscard]] static Seen see(const Side& side, std::size_t i, const PatchView& view,
                                  const PatchView::Use& use);
    std::array<Side, 4> sides_;
};

}  // namespace postlens
