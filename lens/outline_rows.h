// Exact area coverage of a convex polygon over the pixel grid: the geometric impulse response of an aperture
// that is not round.
#pragma once

#include "lens/ellipse_coverage.h"
#include "lens/outline.h"

namespace postlens {

/// Computes how much of each pixel of a row the polygon covers, for rows in any order. Inner pixels are not
/// visited, so all rows together take a time proportional to the length of the outline. Values are shares of
/// the polygon's area and add up to 1 over the plane. Row y covers [y, y + 1).
class OutlineRows {
  public:
    /// `outline` is in px, of either orientation, and has an area of at least 1e-12 px^2.
    explicit OutlineRows(Outline outline);

    /// Rows touched by the polygon.
    [[nodiscard]] int y_begin() const { return y_begin_; }
    [[nodiscard]] int y_end() const { return y_end_; }
    /// Value of a completely covered pixel.
    [[nodiscard]] double inner_share() const { return 1 / area_; }
    /// Computes row y of [y_begin, y_end). Reuses the memory of `out`.
    void row(int y, CoverageSpan& out) const;

  private:
    /// A side, from top to bottom; `sign` +1 for sides on the left.
    struct Side {
        glm::dvec2 top{0}, bottom{0};
        double sign = 1;
    };
    std::vector<Side> sides_;            ///< without horizontal sides
    std::vector<std::uint32_t> of_row_;  ///< indices of sides; those of row i begin at row_begin_[i]
    std::vector<std::uint32_t> row_begin_;
    double area_ = 0;
    int y_begin_ = 0, y_end_ = 0;
};

/// Reference for tests: coverage of one pixel by n x n sample points.
[[nodiscard]] double outline_coverage_reference(const Outline& outline, int x, int y, int n);

}  // namespace postlens
