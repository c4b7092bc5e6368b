// Exact area coverage of a convex polygon over the pixel grid: the geometric impulse response of an aperture
// that is not round.
#pragma once

#include "lens/ellipse_coverage.h"
#include "lens/outline.h"

namespace postlens {

/// Coverage row by row, in any order, without touching the inside: O(outline) for all rows together. Shares
/// of the polygon's area, which add up to 1 over the plane; row y covers [y, y + 1).
class OutlineRows {
  public:
    /// `outline`: in px, of either orientation, with an area of at least 1e-12 px^2.
    explicit OutlineRows(Outline outline);

    /// The rows that the polygon touches.
    [[nodiscard]] int y_begin() const { return y_begin_; }
    [[nodiscard]] int y_end() const { return y_end_; }
    /// Share of a pixel that lies wholly inside.
    [[nodiscard]] double inner_share() const { return 1 / area_; }
    /// Row y of [y_begin, y_end); a buffer given again is reused.
    void row(int y, CoverageSpan& out) const;

  private:
    /// A side, from top to bottom; `sign` +1 for sides on the left.
    struct Side {
        glm::dvec2 top{0}, bottom{0};
        double sign = 1;
    };
    std::vector<Side> sides_;            ///< those that are not level
    std::vector<std::uint32_t> of_row_;  ///< sides by row, those of row i from row_begin_[i] on
    std::vector<std::uint32_t> row_begin_;
    double area_ = 0;
    int y_begin_ = 0, y_end_ = 0;
};

/// The same for one pixel by brute-force subsampling (n x n points): slow, obvious, for tests.
[[nodiscard]] double outline_coverage_reference(const Outline& outline, int x, int y, int n);

}  // namespace postlens
