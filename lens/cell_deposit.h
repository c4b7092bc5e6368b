// Adds many small polygons, each with uniformly distributed energy, to the pixel grid.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "lens/response_grid.h"

namespace postlens {

/// Adds exact area coverages of polygons of either orientation. finish() writes the sums to the grid in one
/// pass.
class CellDeposit {
  public:
    /// Energy is added to `grid`, which must outlive this object.
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
    std::vector<double> after_;  ///< added to this pixel and to all pixels right of it in its row
};

}  // namespace postlens
