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
    /// Spreads energy uniformly over the area of a convex polygon. The corners are in px, in the grid's
    /// coordinates.
    ///
    /// A polygon smaller than 1e-5 px^2 is not integrated exactly. Its energy is divided equally among the
    /// pixels that contain its centre and the midpoints of its sides.
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
