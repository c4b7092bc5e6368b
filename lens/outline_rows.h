// Computes exactly how much of each pixel a convex polygon covers. If the polygon is the image of an
// aperture's outline on the film, this coverage is the impulse response.
#pragma once

#include "lens/ellipse_coverage.h"
#include "lens/outline.h"

namespace postlens {

/// Computes how a polygon covers pixels, one row after the other. For each pixel, it gives the area that the
/// polygon covers in the pixel, divided by the polygon's area. The pixels of row y extend from y to y + 1.
/// Completely covered pixels share one value, so the time depends only on the length of the outline.
class OutlineRows {
  public:
    /// `outline` is a polygon in px, clockwise or anticlockwise, with an area of at least 1e-12 px^2.
    explicit OutlineRows(Outline outline);

    /// The polygon touches the pixel rows y_begin() <= y < y_end().
    [[nodiscard]] int y_begin() const { return y_begin_; }
    [[nodiscard]] int y_end() const { return y_end_; }
    /// Returns the value of a pixel that lies completely inside the polygon: 1 px^2 divided by the polygon's
    /// area.
    [[nodiscard]] double inner_share() const { return 1 / area_; }
    /// Computes how much of the polygon's area lies in each pixel of row y, as a fraction of the whole area,
    /// for a row with y_begin() <= y < y_end(). Reuses the memory of `out`.
    void row(int y, CoverageSpan& out) const;

  private:
    /// A side of the polygon. The polygon's area is a sum over its sides: the area between a side and a
    /// vertical line to the right of the polygon is multiplied by `sign` and added.
    struct Side {
        glm::dvec2 top{0}, bottom{0};
        /// +1 for sides that bound the polygon on its left, -1 for sides that bound it on its right.
        double sign = 1;
    };
    std::vector<Side> sides_;            ///< without horizontal sides
    std::vector<std::uint32_t> of_row_;  ///< indices of sides; those of row i start at row_begin_[i]
    std::vector<std::uint32_t> row_begin_;
    double area_ = 0;
    int y_begin_ = 0, y_end_ = 0;
};

/// Reference for tests. Estimates the coverage of one pixel from n x n sample points.
[[nodiscard]] double outline_coverage_reference(const Outline& outline, int x, int y, int n);

}  // namespace postlens
