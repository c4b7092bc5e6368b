// What may lie beyond the border of the records, and come into view through other points of the lens.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "reproject/patch_field.h"

namespace postlens {

/// Surfaces that the border of the records cuts go on beyond it, as far as anybody knows: straight on, as
/// deep as the nearest that is recorded at the border there.
class BorderReach {
  public:
    /// `views`: all that will be asked about; they use `primary` as their instant of this number.
    BorderReach(const PatchMesh& primary, const PatchField& field, std::size_t instant);
    /// Marks as SeenTile::maybe_inverse_z where a view may see such a thing in a tile.
    void mark(const PatchView& view, const PatchView::Use& use, const TilePlace& at, SeenTile& seen) const;

  private:
    struct Cell {
        float inverse_z = 0;
        std::size_t motion_class = 0;
        bool any = false;
    };
    /// One side of the raster.
    struct Side {
        bool across = false;  ///< left or right, not top or bottom
        bool after = false;   ///< right or bottom
        int first = 0;        ///< raster px of its first cell, along it
        double at = 0;        ///< raster px of the side
        std::vector<Cell> cells;
        double deepest_px = 0, sideways_px = 0;  ///< how far any view may move it into the raster, and along
        /// Takes in a view's motions.
        void reach(const PatchView& view, const PatchView::Use& use);
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
