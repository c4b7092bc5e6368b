// Adds many small polygons, each of uniform energy density, to the pixel grid.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "lens/response_grid.h"

namespace postlens {

/// Adds polygons of either orientation with exact area coverage. finish() writes the sums to the grid in one
/// pass.
class CellDeposit {
  public:
    /// Energy will be added to `grid`, which must outlive this object.
    explicit CellDeposit(ResponseGrid& grid);
    /// Adds a convex polygon, in px relative to the grid's anchor. If its area is below 1e-5 px^2, the energy
    /// is divided among the pixels of its centre and of the midpoints of its sides.
    void add(std::span<const glm::dvec2> corners, double energy);
    /// Writes all sums to the grid.
    void finish();

  private:
    void add_side(const glm::dvec2& from, const glm::dvec2& to, double density);
    void add_point(const glm::dvec2& p, double energy);

    ResponseGrid& grid_;
    std::vector<double> after_;  ///< energy for this pixel and for all pixels to its right in the row
};

}  // namespace postlens
