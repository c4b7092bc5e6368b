// Computes exactly how much of each pixel a disc or an ellipse covers: the impulse response of a round
// aperture.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace postlens {

/// An ellipse, described by its horizontal chords because coverage is computed row by row. At the height y
/// above the centre, the two ends of the chord are at
///
///     centre.x + shear * y +- half_chord * sqrt(1 - (y / half_height)^2)
struct Ellipse {
    double half_height = 0;  ///< > 0
    double half_chord = 0;   ///< > 0, half the chord through the centre
    double shear = 0;
    [[nodiscard]] static Ellipse disc(double radius_px) { return {radius_px, radius_px, 0}; }
    /// Returns the ellipse onto which the matrix `m` maps the unit disc. Semi-axes shorter than `smallest_px`
    /// are lengthened, so that the ellipse has an area.
    [[nodiscard]] static Ellipse from_map(const glm::dmat2& m, double smallest_px);

    [[nodiscard]] double area_px2() const;
    /// Half the width of the ellipse's bounding box.
    [[nodiscard]] double half_width() const;
};

/// How a blur ellipse covers the pixels of one row. For each pixel, `share` holds the fraction of the
/// ellipse's total area that lies in the pixel. The pixels of row y extend from y to y + 1.
struct CoverageRow {
    int y = 0;
    int x_begin = 0;            ///< column of the first value
    std::vector<double> share;  ///< ellipse area in the pixel / ellipse area
};

/// Returns how an ellipse covers the pixels of each row that it touches, from top to bottom. Areas are
/// integrated analytically, so values are exact up to rounding.
[[nodiscard]] std::vector<CoverageRow> ellipse_coverage(const Ellipse& ellipse, double cx, double cy);

/// Reference for tests. Estimates the coverage of one pixel from n x n sample points.
[[nodiscard]] double ellipse_coverage_reference(const Ellipse& ellipse, double cx, double cy, int x, int y,
                                                int n);

/// Coverage of the pixels in one row.
/// - Pixels [inner_begin, inner_end) are completely covered and share one value.
/// - The other pixels in [x_begin, x_end) have values of their own.
struct CoverageSpan {
    int x_begin = 0, inner_begin = 0, inner_end = 0, x_end = 0;
    /// Values of the partly covered pixels: the fraction of the shape's area that lies in each. First come
    /// the columns [x_begin, inner_begin), then [inner_end, x_end).
    std::vector<double> edge_share;
};

/// Computes how an ellipse covers pixels, row by row, in any order. Only the pixels that the ellipse covers
/// partly are computed one by one. The completely covered pixels between them have the same value,
/// inner_share(), and are given as a range of columns. Therefore, the time depends only on the length of the
/// outline.
class EllipseRows {
  public:
    EllipseRows(const Ellipse& ellipse, double cx, double cy);

    /// The ellipse touches the pixel rows y_begin() <= y < y_end().
    [[nodiscard]] int y_begin() const { return y_begin_; }
    [[nodiscard]] int y_end() const { return y_end_; }
    /// Returns the fraction of the ellipse's area in a completely covered pixel: 1 px^2 divided by the
    /// ellipse's area.
    [[nodiscard]] double inner_share() const { return 1 / area_; }
    /// Computes how much of the ellipse's area lies in each pixel of row y, as a fraction of the whole area,
    /// for a row with y_begin() <= y < y_end(). Reuses the memory of `out`.
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
