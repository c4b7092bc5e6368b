// Exact area coverage of a disc or ellipse over the pixel grid: the geometric impulse response of a round
// aperture.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace postlens {

/// The image of the unit disc under a 2x2 linear map, about a centre, in pixels: the set
/// { centre + M u : |u| <= 1 }. Written by rows: on the line at height y the chord is
/// centre.x + shear * y +- half_chord * sqrt(1 - (y / half_height)^2), y measured from centre.y.
struct Ellipse {
    double half_height = 0;  ///< > 0
    double half_chord = 0;   ///< > 0, half the chord through the centre row
    double shear = 0;
    [[nodiscard]] static Ellipse disc(double radius_px) { return {radius_px, radius_px, 0}; }
    /// From the columns of M; semi-axes below `smallest_px` are raised to it, so that it has an area.
    [[nodiscard]] static Ellipse from_map(const glm::dmat2& m, double smallest_px);

    [[nodiscard]] double area_px2() const;
    /// Half the width of the bounding box.
    [[nodiscard]] double half_width() const;
};

/// Covered share of each pixel: values add up to 1 over the whole plane. Row y covers [y, y + 1).
struct CoverageRow {
    int y = 0;
    int x_begin = 0;            ///< column of the first value
    std::vector<double> share;  ///< ellipse area in the pixel / ellipse area
};

/// Coverage of the ellipse centred at (cx, cy), every row it touches, top to bottom. Exact up to rounding:
/// areas come from antiderivatives, not from sampling.
[[nodiscard]] std::vector<CoverageRow> ellipse_coverage(const Ellipse& ellipse, double cx, double cy);

/// The same for one pixel by brute-force subsampling (n x n points): slow, obvious, for tests.
[[nodiscard]] double ellipse_coverage_reference(const Ellipse& ellipse, double cx, double cy, int x, int y,
                                                int n);

/// One row as a span: pixels [inner_begin, inner_end) lie wholly inside and share one value, so a row costs
/// as much as its outline. Nothing is covered outside [x_begin, x_end); x_begin <= inner_begin <= inner_end
/// <= x_end.
struct CoverageSpan {
    int x_begin = 0, inner_begin = 0, inner_end = 0, x_end = 0;
    /// Shares of [x_begin, inner_begin), then of [inner_end, x_end).
    std::vector<double> edge_share;
};

/// Coverage row by row, in any order, without touching the inside: O(outline) for all rows together.
class EllipseRows {
  public:
    EllipseRows(const Ellipse& ellipse, double cx, double cy);

    /// The rows that the ellipse touches.
    [[nodiscard]] int y_begin() const { return y_begin_; }
    [[nodiscard]] int y_end() const { return y_end_; }
    /// Share of a pixel that lies wholly inside.
    [[nodiscard]] double inner_share() const { return 1 / area_; }
    /// Row y of [y_begin, y_end); a buffer given again is reused.
    void row(int y, CoverageSpan& out) const;

  private:
    struct Strip;
    [[nodiscard]] double left_edge(double t) const;
    [[nodiscard]] double right_edge(double t) const;
    [[nodiscard]] double area_left_of(const Strip& strip, double x) const;

    Ellipse e_;
    double cx_, cy_;
    double area_;
    int y_begin_, y_end_;
};

}  // namespace postlens
