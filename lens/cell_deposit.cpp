#include "lens/cell_deposit.h"

#include <algorithm>
#include <cmath>

namespace postlens {

using glm::dvec2;

CellDeposit::CellDeposit(ResponseGrid& grid) : grid_(grid), after_(grid.share.size(), 0) {}

void CellDeposit::add_point(const dvec2& p, double energy) {
    const double x = std::floor(p.x) - grid_.x_begin, y = std::floor(p.y) - grid_.y_begin;
    if (!(x >= 0 && x < grid_.width && y >= 0 && y < grid_.height)) return;
    grid_.at(static_cast<int>(x), static_cast<int>(y)) += energy;
}

void CellDeposit::add(std::span<const dvec2> corners, double energy) {
    double twice = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        // Computes the polygon's area from its corners, relative to the first corner. With coordinates
        // relative to the grid's origin, rounding would falsify the area of small, distant polygons.
        const dvec2 a = corners[i] - corners[0], b = corners[(i + 1) % corners.size()] - corners[0];
        twice += a.x * b.y - a.y * b.x;
    }
    constexpr double least_px2 = 1e-5;
    if (std::abs(twice) < 2 * least_px2) {
        const double part = energy / (static_cast<double>(corners.size()) + 1);
        dvec2 sum(0);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            sum += corners[i];
            add_point((corners[i] + corners[(i + 1) % corners.size()]) / 2.0, part);
        }
        add_point(sum / static_cast<double>(corners.size()), part);
        return;
    }
    const double density = 2 * energy / twice;
    for (std::size_t i = 0; i < corners.size(); ++i)
        add_side(corners[i], corners[(i + 1) % corners.size()], density);
}

// Processes one side of a polygon that is filled uniformly with energy, `density` per px^2. The energy
// between the side and the grid's right edge is added if the side runs upwards, and subtracted otherwise. In
// the sum over all sides, only the energy inside the polygon remains.
void CellDeposit::add_side(const dvec2& from, const dvec2& to, double density) {
    const dvec2 a = from - dvec2(grid_.x_begin, grid_.y_begin), b = to - dvec2(grid_.x_begin, grid_.y_begin);
    const double sign = a.y > b.y ? density : -density;
    const dvec2 top = a.y < b.y ? a : b, bottom = a.y < b.y ? b : a;
    if (!(bottom.y > top.y)) return;
    const double slope = (bottom.x - top.x) / (bottom.y - top.y);
    const double x_low = std::min(a.x, b.x), x_high = std::max(a.x, b.x);
    const double y0 = std::max(top.y, 0.0), y1 = std::min(bottom.y, static_cast<double>(grid_.height));
    for (int row = static_cast<int>(y0); row < y1; ++row) {
        const double low = std::max(y0, static_cast<double>(row)), high = std::min(y1, row + 1.0);
        const double height = sign * (high - low);
        const double at_low = std::clamp(top.x + slope * (low - top.y), x_low, x_high),
                     at_high = std::clamp(top.x + slope * (high - top.y), x_low, x_high);
        const double x0 = std::min(at_low, at_high), x1 = std::max(at_low, at_high);
        double* share =
            grid_.share.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.width);
        double* after = after_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.width);
        if (x1 <= 0) {
            after[0] += height;
            continue;
        }
        if (x0 >= grid_.width) continue;
        const double width = x1 - x0;
        // Where a side of the polygon lies left of the grid (x < 0), it adds energy to every pixel of the
        // row. This part is therefore added to `after[0]`, which counts for all of them.
        double inside = 1;
        if (x0 < 0) {
            const double left = -x0 / width;
            after[0] += left * height;
            // Only this fraction of the side is treated pixel by pixel.
            inside = 1 - left;
        }
        const double begin = std::max(x0, 0.0), end = std::min(x1, static_cast<double>(grid_.width));
        if (x1 > grid_.width) inside = (end - begin) / width;
        for (double x = begin;;) {
            const auto column = static_cast<std::size_t>(std::min(x, grid_.width - 1.0));
            const double next = std::min(end, static_cast<double>(column) + 1);
            const double part = end > begin ? inside * (next - x) / (end - begin) : inside;
            share[column] += height * part * (static_cast<double>(column) + 1 - (x + next) / 2);
            if (column + 1 < static_cast<std::size_t>(grid_.width)) after[column + 1] += height * part;
            if (!(next < end)) break;
            x = next;
        }
    }
}

void CellDeposit::finish() {
    for (int y = 0; y < grid_.height; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(grid_.width);
        double sum = 0;
        for (std::size_t x = 0; x < static_cast<std::size_t>(grid_.width); ++x) {
            sum += after_[row + x];
            // `sum` is the energy that polygon sides to the left of this pixel add to it. Outside a polygon,
            // the terms of the polygon's left and right sides cancel. But rounding can leave a small negative
            // energy there, so negative values become 0.
            grid_.share[row + x] = std::max(0.0, grid_.share[row + x] + sum);
        }
    }
    std::fill(after_.begin(), after_.end(), 0.0);
}

}  // namespace postlens
