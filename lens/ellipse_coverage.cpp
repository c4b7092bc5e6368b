#include "lens/ellipse_coverage.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace postlens {

Ellipse Ellipse::from_map(const glm::dmat2& m, double smallest_px) {
    // The matrix m maps the unit circle to the ellipse. Computes the elements of the symmetric matrix m m^T,
    // whose eigenvalues are the squared semi-axes of this ellipse.
    double xx = m[0].x * m[0].x + m[1].x * m[1].x;
    double xy = m[0].x * m[0].y + m[1].x * m[1].y;
    double yy = m[0].y * m[0].y + m[1].y * m[1].y;
    const double mean = (xx + yy) / 2;
    // std::sqrt is five times as fast as std::hypot, and squared lengths in px cannot overflow here.
    const double spread = std::sqrt((xx - yy) * (xx - yy) / 4 + xy * xy);
    const double det = m[0].x * m[1].y - m[0].y * m[1].x;
    const double smallest_squared = smallest_px * smallest_px;
    const double major = mean + spread;
    const double minor = major > 0 ? det * det / major : 0;
    if (major <= smallest_squared) return disc(smallest_px);
    if (minor < smallest_squared) {
        // Widens the ellipse, because its smaller semi-axis is below smallest_px. The vector a is the unit
        // vector along the major axis.
        const double a_xx = spread > 0 ? (1 + (xx - yy) / 2 / spread) / 2 : 1;
        const double a_yy = 1 - a_xx;
        const double a_xy = spread > 0 ? xy / 2 / spread : 0;
        // The matrix of the ellipse is minor * I + (major - minor) * a a^T, where `major` and `minor` are the
        // squares of the semi-axes. Here, smallest_px^2 replaces `minor`.
        xx = smallest_squared + (major - smallest_squared) * a_xx;
        yy = smallest_squared + (major - smallest_squared) * a_yy;
        xy = (major - smallest_squared) * a_xy;
        return {std::sqrt(yy), std::sqrt(major * smallest_squared / yy), xy / yy};
    }
    return {std::sqrt(yy), std::abs(det) / std::sqrt(yy), xy / yy};
}

double Ellipse::area_px2() const {
    return std::numbers::pi * half_height * half_chord;
}

double Ellipse::half_width() const {
    const double sheared = shear * half_height;
    return std::sqrt(half_chord * half_chord + sheared * sheared);
}

/// The part of an ellipse within one pixel row, from height t0 to t1 above the ellipse's centre.
struct EllipseRows::Strip {
    double t0, t1;
    double segment0, segment1;  ///< antiderivative of sqrt(1 - (t / H)^2) at t0 and t1
    double height;
};

namespace {

double root_at(const Ellipse& e, double t) {
    const double u = t / e.half_height;
    return std::sqrt(std::max(0.0, (1 - u) * (1 + u)));
}

/// Antiderivative of sqrt(1 - (t / H)^2) at t, where H is the ellipse's half height.
double segment_at(const Ellipse& e, double t) {
    const double u = std::clamp(t / e.half_height, -1.0, 1.0);
    return (t * root_at(e, t) + e.half_height * std::asin(u)) / 2;
}

}  // namespace

EllipseRows::EllipseRows(const Ellipse& ellipse, double cx, double cy)
    : e_(ellipse),
      cx_(cx),
      cy_(cy),
      area_(ellipse.area_px2()),
      y_begin_(static_cast<int>(std::floor(cy - ellipse.half_height))),
      y_end_(static_cast<int>(std::ceil(cy + ellipse.half_height))) {
    assert(ellipse.half_height > 0 && ellipse.half_chord > 0);
    // Rounding can make the height of a very flat ellipse 0. It still covers one row of pixels.
    if (y_end_ == y_begin_) ++y_end_;
}

double EllipseRows::left_edge(double t) const {
    return e_.shear * t - e_.half_chord * root_at(e_, t);
}

double EllipseRows::right_edge(double t) const {
    return e_.shear * t + e_.half_chord * root_at(e_, t);
}

/// Returns the part of an ellipse's area that lies in the horizontal strip `strip` and to the left of the
/// vertical line at x. Coordinates are relative to the ellipse's centre.
double EllipseRows::area_left_of(const Strip& strip, double x) const {
    const double k = e_.shear;
    const double s = e_.half_chord;
    // A vertical line at x crosses the ellipse's outline at up to two heights t, which are the solutions of
    // the equation below. k is the shear, s half the chord through the centre, and H half the ellipse's
    // height.
    //
    //     (x - k t)^2 = s^2 (1 - (t / H)^2)
    const double a = k * k + s * s / (e_.half_height * e_.half_height);
    const double quarter_discriminant = s * s * (a - x * x / (e_.half_height * e_.half_height));
    std::array<double, 4> t{strip.t0, strip.t0, strip.t1, strip.t1};
    std::array<double, 4> segment{strip.segment0, strip.segment0, strip.segment1, strip.segment1};
    if (quarter_discriminant > 0) {
        const double root = std::sqrt(quarter_discriminant);
        const double lower = (k * x - root) / a;
        const double upper = (k * x + root) / a;
        if (lower > strip.t0 && lower < strip.t1) {
            t[1] = lower;
            segment[1] = segment_at(e_, lower);
        }
        if (upper > strip.t0 && upper < strip.t1) {
            t[2] = upper;
            segment[2] = segment_at(e_, upper);
        } else if (upper <= strip.t0) {
            t[2] = t[1];
            segment[2] = segment[1];
        }
        if (lower >= strip.t1) {
            t[1] = strip.t1;
            segment[1] = strip.segment1;
        }
    }
    double area = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        // Between the heights t[i] and t[i + 1], integrates the length of the ellipse's chord to the left of
        // the line: min(right_edge(t), x) - min(left_edge(t), x).
        const double width = t[i + 1] - t[i];
        if (!(width > 0)) continue;
        const double middle = (t[i] + t[i + 1]) / 2;
        const double ramp = k * middle * width;
        const double bulge = s * (segment[i + 1] - segment[i]);
        const double right = right_edge(middle) < x ? ramp + bulge : x * width;
        const double left = left_edge(middle) < x ? ramp - bulge : x * width;
        area += right - left;
    }
    return area;
}

void EllipseRows::row(int y, CoverageSpan& out) const {
    Strip strip{};
    strip.t0 = std::max(y - cy_, -e_.half_height);
    strip.t1 = std::min(y + 1 - cy_, e_.half_height);
    strip.height = std::max(0.0, strip.t1 - strip.t0);
    strip.segment0 = segment_at(e_, strip.t0);
    strip.segment1 = segment_at(e_, strip.t1);
    const double total = e_.half_chord * 2 * std::max(0.0, strip.segment1 - strip.segment0);

    const double widest = e_.half_width();
    const double t_widest = widest > 0 ? e_.half_height * (e_.shear * e_.half_height / widest) : 0;
    double x_max = std::max(right_edge(strip.t0), right_edge(strip.t1));
    double x_min = std::min(left_edge(strip.t0), left_edge(strip.t1));
    if (t_widest > strip.t0 && t_widest < strip.t1) x_max = widest;
    if (-t_widest > strip.t0 && -t_widest < strip.t1) x_min = -widest;
    out.x_begin = static_cast<int>(std::floor(cx_ + x_min));
    out.x_end = std::max(out.x_begin + 1, static_cast<int>(std::ceil(cx_ + x_max)));

    out.inner_begin = out.inner_end = out.x_end;
    if (y - cy_ >= -e_.half_height && y + 1 - cy_ <= e_.half_height) {
        const double inner_left = std::max(left_edge(strip.t0), left_edge(strip.t1));
        const double inner_right = std::min(right_edge(strip.t0), right_edge(strip.t1));
        const int begin = static_cast<int>(std::ceil(cx_ + inner_left));
        const int end = static_cast<int>(std::floor(cx_ + inner_right));
        if (begin < end) {
            out.inner_begin = std::clamp(begin, out.x_begin, out.x_end);
            out.inner_end = std::clamp(end, out.inner_begin, out.x_end);
        }
    }

    out.edge_share.clear();
    // Computes a pixel's covered area as a difference: the ellipse's area left of the pixel's right border,
    // minus its area left of the pixel's left border. Neighbours share a border, so a row adds up without
    // rounding errors.
    const auto add_edge = [&](int begin, int end, double area_at_begin, double area_at_end) {
        double before = area_at_begin;
        for (int x = begin; x < end; ++x) {
            const double after = x + 1 == end ? area_at_end : area_left_of(strip, x + 1 - cx_);
            out.edge_share.push_back(std::max(0.0, after - before) / area_);
            before = std::max(before, after);
        }
    };
    if (out.inner_begin == out.inner_end) {
        out.inner_begin = out.inner_end = out.x_end;
        add_edge(out.x_begin, out.x_end, 0, total);
        return;
    }
    const double area_at_inner = area_left_of(strip, out.inner_begin - cx_);
    add_edge(out.x_begin, out.inner_begin, 0, area_at_inner);
    add_edge(out.inner_end, out.x_end, area_at_inner + strip.height * (out.inner_end - out.inner_begin),
             total);
}

std::vector<CoverageRow> ellipse_coverage(const Ellipse& ellipse, double cx, double cy) {
    const EllipseRows rows(ellipse, cx, cy);
    std::vector<CoverageRow> out;
    out.reserve(static_cast<std::size_t>(rows.y_end() - rows.y_begin()));
    CoverageSpan span;
    for (int y = rows.y_begin(); y < rows.y_end(); ++y) {
        rows.row(y, span);
        CoverageRow row{.y = y, .x_begin = span.x_begin, .share = {}};
        const auto left = static_cast<std::ptrdiff_t>(span.inner_begin - span.x_begin);
        row.share.assign(span.edge_share.begin(), span.edge_share.begin() + left);
        row.share.insert(row.share.end(), static_cast<std::size_t>(span.inner_end - span.inner_begin),
                         rows.inner_share());
        row.share.insert(row.share.end(), span.edge_share.begin() + left, span.edge_share.end());
        out.push_back(std::move(row));
    }
    return out;
}

double ellipse_coverage_reference(const Ellipse& ellipse, double cx, double cy, int x, int y, int n) {
    std::int64_t inside = 0;
    for (int j = 0; j < n; ++j) {
        const double t = y + (j + 0.5) / n - cy;
        const double u = t / ellipse.half_height;
        for (int i = 0; i < n; ++i) {
            const double v = (x + (i + 0.5) / n - cx - ellipse.shear * t) / ellipse.half_chord;
            if (u * u + v * v <= 1) ++inside;
        }
    }
    return static_cast<double>(inside) / n / n / ellipse.area_px2();
}

}  // namespace postlens
