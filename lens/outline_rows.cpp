#include "lens/outline_rows.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace postlens {
namespace {

/// The part of one side of the polygon that lies within one row of pixels.
struct Piece {
    double x_low, x_high;  ///< x coordinates of the two ends of the piece of outline
    double height;         ///< positive height times the `sign` of the side
};

/// Returns which fraction of the pixel column [x, x + 1) lies to the right of a straight piece of the
/// outline. The piece may be slanted, so the fraction is averaged over the heights that it spans.
double right_of(const Piece& p, double x) {
    // `integral` is an antiderivative of clamp(x + 1 - at, 0, 1), the fraction of the pixel [x, x + 1) to the
    // right of a vertical line at `at`. With it, the fraction is averaged over a slanted piece of the
    // outline, whose position changes from x_low to x_high.
    const auto integral = [x](double at) {
        if (at <= x) return at - x;
        const double into = std::min(at - x, 1.0);
        return into - into * into / 2;
    };
    const double width = p.x_high - p.x_low;
    // The result is the mean over the piece of the outline, which extends horizontally from x_low to x_high.
    // If the piece is almost vertical, the division by `width` would amplify rounding errors. Such a piece is
    // therefore treated as a vertical line through its midpoint.
    if (width < 1e-9) return std::clamp(x + 1 - (p.x_low + p.x_high) / 2, 0.0, 1.0);
    return (integral(p.x_high) - integral(p.x_low)) / width;
}

}  // namespace

OutlineRows::OutlineRows(Outline outline) {
    double signed_area = area(outline);
    if (signed_area < 0) {
        std::reverse(outline.begin(), outline.end());
        signed_area = -signed_area;
    }
    area_ = signed_area;
    assert(area_ > 0);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
        low = std::min(low, a.y);
        high = std::max(high, a.y);
        // A side that bounds the polygon on its left has the sign +1, and a side that bounds it on its right
        // has -1. Because the corners are in clockwise order and y points down, the outline runs upwards (b.y
        // < a.y) along the left sides.
        if (a.y == b.y) continue;
        sides_.push_back(a.y < b.y ? Side{a, b, -1} : Side{b, a, 1});
    }
    y_begin_ = static_cast<int>(std::floor(low));
    y_end_ = std::max(y_begin_ + 1, static_cast<int>(std::ceil(high)));
    row_begin_.assign(static_cast<std::size_t>(y_end_ - y_begin_) + 1, 0);
    const auto for_rows = [&](const Side& s, const auto& visit) {
        const int first = static_cast<int>(std::floor(s.top.y)) - y_begin_;
        const int last = std::min(static_cast<int>(std::ceil(s.bottom.y)), y_end_) - y_begin_;
        for (int r = first; r < std::max(last, first + 1); ++r) visit(static_cast<std::size_t>(r));
    };
    for (const Side& s : sides_) for_rows(s, [&](std::size_t r) { ++row_begin_[r + 1]; });
    for (std::size_t r = 1; r < row_begin_.size(); ++r) row_begin_[r] += row_begin_[r - 1];
    of_row_.resize(row_begin_.back());
    std::vector<std::uint32_t> next(row_begin_.begin(), row_begin_.end() - 1);
    for (std::uint32_t i = 0; i < sides_.size(); ++i)
        for_rows(sides_[i], [&](std::size_t r) { of_row_[next[r]++] = i; });
}

void OutlineRows::row(int y, CoverageSpan& out) const {
    const auto r = static_cast<std::size_t>(y - y_begin_);
    thread_local std::vector<Piece> pieces;
    pieces.clear();
    double x_min = std::numeric_limits<double>::infinity(), x_max = -x_min;
    double left_end = x_max, right_begin = x_min, left_height = 0, right_height = 0;
    for (std::uint32_t i = row_begin_[r]; i < row_begin_[r + 1]; ++i) {
        const Side& s = sides_[of_row_[i]];
        const double top = std::max(s.top.y, static_cast<double>(y)), bottom = std::min(s.bottom.y, y + 1.0);
        if (!(bottom > top)) continue;
        const double slope = (s.bottom.x - s.top.x) / (s.bottom.y - s.top.y);
        const auto at = [&](double height) {
            return std::clamp(s.top.x + slope * (height - s.top.y), std::min(s.top.x, s.bottom.x),
                              std::max(s.top.x, s.bottom.x));
        };
        const double a = at(top), b = at(bottom);
        pieces.push_back({std::min(a, b), std::max(a, b), s.sign * (bottom - top)});
        x_min = std::min(x_min, pieces.back().x_low);
        x_max = std::max(x_max, pieces.back().x_high);
        if (s.sign > 0) {
            left_end = std::max(left_end, pieces.back().x_high);
            left_height += bottom - top;
        } else {
            right_begin = std::min(right_begin, pieces.back().x_low);
            right_height += bottom - top;
        }
    }
    out.edge_share.clear();
    if (pieces.empty()) {  // the polygon touches this row only in a point or along a horizontal side
        out.x_begin = out.inner_begin = out.inner_end = out.x_end = 0;
        return;
    }
    out.x_begin = static_cast<int>(std::floor(x_min));
    out.x_end = std::max(out.x_begin + 1, static_cast<int>(std::ceil(x_max)));
    out.inner_begin = out.inner_end = out.x_end;
    constexpr double whole = 1 - 1e-12;
    if (left_height >= whole && right_height >= whole) {
        const int begin = std::max(out.x_begin, static_cast<int>(std::ceil(left_end)));
        const int end = std::min(out.x_end, static_cast<int>(std::floor(right_begin)));
        if (begin < end) {
            out.inner_begin = begin;
            out.inner_end = end;
        }
    }
    const int gap = out.inner_end - out.inner_begin;
    const auto count = static_cast<std::size_t>(out.x_end - out.x_begin - gap);
    const auto place = [&](int x) {
        return static_cast<std::size_t>((x >= out.inner_end ? x - gap : x) - out.x_begin);
    };
    thread_local std::vector<double> after;
    after.assign(count + 1, 0);
    out.edge_share.assign(count, 0);
    for (const Piece& p : pieces) {
        const int first = std::clamp(static_cast<int>(std::floor(p.x_low)), out.x_begin, out.x_end - 1);
        const int last = std::clamp(static_cast<int>(std::floor(p.x_high)), first, out.x_end - 1);
        for (int x = first; x <= last; ++x) {
            if (x >= out.inner_begin && x < out.inner_end) continue;  // only touches the pixel border
            out.edge_share[place(x)] += p.height * right_of(p, x);
        }
        const int next = last + 1;
        if (next < out.x_end)
            after[place(next >= out.inner_begin && next < out.inner_end ? out.inner_end : next)] += p.height;
    }
    double carried = 0;
    for (std::size_t i = 0; i < count; ++i) {
        carried += after[i];
        out.edge_share[i] = std::max(0.0, out.edge_share[i] + carried) / area_;
    }
}

double outline_coverage_reference(const Outline& outline, int x, int y, int n) {
    const double direction = area(outline) < 0 ? -1 : 1;
    int inside = 0;
    for (int k = 0; k < n * n; ++k) {
        const int column = k % n, row = k / n;
        const glm::dvec2 p(x + (column + 0.5) / n, y + (row + 0.5) / n);
        bool in = true;
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const glm::dvec2 a = outline[i], along = outline[(i + 1) % outline.size()] - a;
            in = in && direction * (along.x * (p.y - a.y) - along.y * (p.x - a.x)) >= 0;
        }
        inside += in ? 1 : 0;
    }
    return static_cast<double>(inside) / n / n / (direction * area(outline));
}

}  // namespace postlens
