// Many small polygons, each spreading its energy evenly, summed up over the pixel grid.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "lens/response_grid.h"

namespace postlens {

/// Exact area coverage of every polygon, whatever its orientation; one pass over the grid at the end.
class CellDeposit {
  public:
    /// Adds to `grid`, which must outlive this.
    explicit CellDeposit(ResponseGrid& grid);
    /// A convex polygon, px relative to the grid's anchor. One of less than 1e-5 px^2 gives its energy to the
    /// pixels of its middle and of the middles of its sides.
    void add(std::span<const glm::dvec2> corners, double energy);
    /// Moves all sums into the grid.
    void finish();

  private:
    void add_side(const glm::dvec2& from, const glm::dvec2& to, double density);
    void add_point(const glm::dvec2& p, double energy);

    ResponseGrid& grid_;
    std::vector<double> after_;  ///< what all pixels of the row from here on have
};

}  // namespace postlens
