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

/// A surface at the border of the records may continue beyond it. It is assumed to continue at constant
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
        bool across = false;  ///< true: left or right side; false: top or bottom
        bool after = false;   ///< true: right or bottom side
        int first = 0;        ///< raster px of the first cell, along the side
        double at = 0;        ///< raster px of the side itself
        std::vector<Cell> cells;
        /// Largest displacement of a cell in any view: into the raster, and along the side.
        double deepest_px = 0, sideways_px = 0;
        /// Includes a cell that is displaced by `moved_px`, with a tolerance of `around_px`.
        void widen(const glm::dvec2& moved_px, const glm::dvec2& around_px);
        /// Includes the moving cells in the views of a time span.
        void widen(const TimeSpanViews& span, const LensReach& lens);
    };
    /// Position in a view, raster px along and across the side, of the middle of cell `i` on the side.
    struct Seen {
        double along = 0, across = 0, inverse_z = 0;
        bool any = false;
    };
    [[nodiscard]] static Seen see(const Side& side, std::size_t i, const PatchView& view,
                                  const PatchView::Use& use);
    std::array<Side, 4> sides_;
};

}  // namespace postlens
