// Surfaces beyond the border of the records, which other lens points may see.
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

/// Where views may see surfaces beyond the border of the recorded pixels. A surface at the border is assumed
/// to continue beyond it, at the nearest depth that is recorded there.
class BorderReach {
  public:
    /// `instant`: index of the field's instant whose patches of primary nodes are `primary`.
    BorderReach(const PatchMesh& primary, const PatchField& field, std::size_t instant);
    /// Sets SeenTile::maybe_inverse_z in the pixels where a view may see a surface from beyond the border.
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
        /// Extends the bounds by a border cell whose displacement is `moved_px`, uncertain by `around_px`.
        void widen(const glm::dvec2& moved_px, const glm::dvec2& around_px);
        /// Extends the bounds by the moving border cells, in all views of a time span.
        void widen(const TimeSpanViews& span, const LensReach& lens);
    };
    /// Where a view shows the middle of border cell `i`: raster px along and across the side of the raster.
    struct Seen {
        double along = 0, across = 0, inverse_z = 0;
        bool any = false;
    };
    [[nodiscard]] static Seen see(const Side& side, std::size_t i, const PatchView& view,
                                  const PatchView::Use& use);
    std::array<Side, 4> sides_;
};

}  // namespace postlens
