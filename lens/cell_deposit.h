// Adds many small polygons of uniform energy density to a pixel grid.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "lens/response_grid.h"

namespace postlens {

/// Spreads the energy of polygons over the pixels of a grid, in proportion to the exactly covered area.
class CellDeposit {
  public:
    /// finish() will add energy to `grid`, which must outlive this object.
    explicit CellDeposit(ResponseGrid& grid);
    /// Spreads energy uniformly over the pixels that a convex polygon covers. Corners are in px, in the
    /// grid's coordinates.
    ///
    /// The energy of a polygon below 1e-5 px^2 is divided among the pixels at its centre and at the midpoints
    /// of its sides.
    void add(std::span<const glm::dvec2> corners, double energy);
    /// Adds the energy of all polygons to the grid.
    void finish();

  private:
    void add_side(const glm::dvec2& from, const glm::dvec2& to, double density);
    void add_point(const glm::dvec2& p, double energy);

    ResponseGrid& grid_;
    std::vector<double> after_;  ///< energy of this pixel and of each pixel to its right in the row
};

}  // namespace postlens
