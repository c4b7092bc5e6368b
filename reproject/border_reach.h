// Surfaces beyond the border of the records, which other lens points may see.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "reproject/patch_field.h"
#include "reproject/time_spans.h"

namespace postlens {

/// A surface that the border of the records cuts may continue beyond it. It is assumed to do so at constant
/// depth, the nearest that is recorded at the border there.
class BorderReach {
  public:
    /// `instant`: the number of `primary` among the field's instants.
    BorderReach(const PatchMesh& primary, const PatchField& field, std::size_t instant);
    /// Sets SeenTile::maybe_inverse_z in the pixels where a view may see such a surface.
    void mark(const PatchView& view, const PatchView::Use& use, const TilePlace& at, SeenTile& seen) const;

  private:
    struct Cell {
        float inverse_z = 0;
        std::size_t motion_class = 0;
        bool any = false;
    };
    /// Upper bound of the shift by the lens over all views.
    struct LensReach {
        glm::dvec2 lens_px{0}, offset_px{0};
        double nearest_focus_per_m = 0, farthest_focus_per_m = std::numeric_limits<double>::infinity();
        void add(const LensShift& view);
        [[nodiscard]] glm::dvec2 px(double inverse_z) const;
    };
    /// One side of the raster.
    struct Side {
        bool across = false;  ///< left or right, not top or bottom
        bool after = false;   ///< right or bottom
        int first = 0;        ///< raster px of its first cell, along it
        double at = 0;        ///< raster px of the side
        std::vector<Cell> cells;
        double deepest_px = 0, sideways_px = 0;  ///< how far any view may move it into the raster, and along
        /// For a cell that lies so far from where it was recorded, or as much around that.
        void widen(const glm::dvec2& moved_px, const glm::dvec2& around_px);
        /// For what moves.
        void widen(const TimeSpanViews& span, const LensReach& lens);
    };
    /// Where a view sees the middle of the side of cell `i`: along the side, and across.
    struct Seen {
        double along = 0, across = 0, inverse_z = 0;
        bool any = false;
    };
    [[nodiscard]] static Seen see(const Side& side, std::size_t i, const PatchView& view,
                                  const PatchView::Use& use);
    std::array<Side, 4> sides_;
};

}  // namespace postlens
