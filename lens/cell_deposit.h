// Adds many small polygons, each with evenly spread energy, to the pixel grid.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "lens/response_grid.h"

namespace postlens {

/// Adds exact area coverages, for either orientation of a polygon; the grid is written in one pass at the
/// end.
class CellDeposit {
  public:
    /// Adds to `grid`, which must outlive this.
    explicit CellDeposit(ResponseGrid& grid);
    /// Adds a convex polygon, px relative to the grid's anchor. A polygon below 1e-5 px^2 gives its energy to
    /// the pixels of its centre and of the midpoints of its sides.
    void add(std::span<const glm::dvec2> corners, double energy);
    /// Writes all sums to the grid.
    void finish();

  private:
    void add_side(const glm::dvec2& from, const glm::dvec2& to, double density);
    void add_point(const glm::dvec2& p, double energy);

    ResponseGrid& grid_;
    std::vector<double> after_;  ///< what all pixels of the row from here on have
};

}  // namespace postlens
