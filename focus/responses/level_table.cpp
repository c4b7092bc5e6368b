#include "focus/responses/level_table.h"

#include <algorithm>
#include <cstddef>

#include "core/multiversion.h"

namespace postlens {
namespace {

constexpr double even_px = LevelTable::even_diameter_px;
/// Step between the CoC diameters for which blur kernels are computed, in px. It is used for medium
/// diameters, from small_px to even_px. A diameter between two steps is rounded to the nearer one, which
/// changes it by less than a quarter pixel.
constexpr double step_diameter_px = 0.49;
/// Two limits of the steps between the CoC diameters for which blur kernels are computed. They apply to
/// diameters up to small_px. There, each step is 2 % of the diameter (small_step_share), but at least 0.125
/// px (small_step_px). Larger steps would visibly change the brightness of small highlights.
constexpr double small_step_px = 0.125, small_step_share = 0.02;
constexpr double smallest_px = small_step_px / small_step_share,
                 small_px = step_diameter_px / small_step_share;
/// CoC diameters below this, in px, are not blurred, because such a small blur would be hardly visible.
constexpr double sharp_below_px = 0.4;
/// Number of CoC diameters between d and e d, where e is Euler's number, for which blur kernels are computed.
/// This applies to diameters above even_px, which are therefore spaced logarithmically: each is 0.2 % larger
/// than the last.
constexpr double levels_per_e = 500;
const double smallest_levels = smallest_px / small_step_px,
             small_levels = smallest_levels + std::log(small_px / smallest_px) / small_step_share,
             even_levels = small_levels + (even_px - small_px) / step_diameter_px;

/// Converts a CoC diameter, in px, to its depth level (number of a blur kernel). The result is a real number,
/// which is not yet rounded to an integer. The inverse function is diameter_after.
double steps_to(double diameter_px) {
    if (diameter_px < sharp_below_px) return 0;
    if (diameter_px <= smallest_px) return diameter_px / small_step_px;
    if (diameter_px <= small_px)
        return smallest_levels + std::log(diameter_px / smallest_px) / small_step_share;
    if (diameter_px <= even_px) return small_levels + (diameter_px - small_px) / step_diameter_px;
    return even_levels + levels_per_e * std::log(diameter_px / even_px);
}

double diameter_after(double steps) {
    if (steps <= smallest_levels) return steps * small_step_px;
    if (steps <= small_levels) return smallest_px * std::exp((steps - smallest_levels) * small_step_share);
    if (steps <= even_levels) return small_px + (steps - small_levels) * step_diameter_px;
    return even_px * std::exp((steps - even_levels) / levels_per_e);
}

/// Number of depths that are converted at once to depth levels (numbers of blur kernels). First, the CoC
/// diameters of all these depths are computed with SIMD. Then, the level is looked up for each diameter, in a
/// table.
constexpr std::size_t together = 128;

POSTLENS_MULTIVERSION
void find_cells(int cells_per_px, int end_px, const FocusGeometry& geometry,
                const double* __restrict inverse_depth_per_m, std::size_t count, double* __restrict wide_px,
                std::int32_t* __restrict cell) {
    const FocusGeometry g = geometry;
    for (std::size_t i = 0; i < count; ++i) {
        wide_px[i] = std::abs(g.coc_diameter_px(inverse_depth_per_m[i]));
        cell[i] = static_cast<std::int32_t>((wide_px[i] < end_px ? wide_px[i] : 0.0) * cells_per_px);
    }
}

}  // namespace

double LevelTable::diameter_px(std::uint32_t level) {
    return diameter_after(level);
}

std::uint32_t LevelTable::nearest_level(double diameter_px) {
    return static_cast<std::uint32_t>(
        std::lround(steps_to(std::min(std::abs(diameter_px), largest_diameter_px))));
}

LevelTable::LevelTable() {
    for (std::size_t i = 0; i < cells; ++i) {
        double low = static_cast<double>(i) / cells_per_px, high = static_cast<double>(i + 1) / cells_per_px;
        const std::uint32_t first = nearest_level(low), last = nearest_level(std::nextafter(high, 0));
        while (first != last && std::nextafter(low, high) < high) {
            const double middle = low + (high - low) / 2;
            (nearest_level(middle) == first ? low : high) = middle;
        }
        begin_px_[i] = high;
        before_[i] = static_cast<std::int32_t>(first);
        step_[i] = static_cast<std::int32_t>(last - first);
    }
}

const LevelTable& LevelTable::the() {
    static const LevelTable table;
    return table;
}

void LevelTable::levels_of(const FocusGeometry& geometry, const double* inverse_depth_per_m,
                           std::size_t count, std::uint32_t* level) const {
    std::array<double, together> wide_px;     // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
    std::array<std::int32_t, together> cell;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
    for (std::size_t begin = 0; begin < count; begin += together) {
        const std::size_t part = std::min(together, count - begin);
        find_cells(cells_per_px, end_px, geometry, inverse_depth_per_m + begin, part, wide_px.data(),
                   cell.data());
        for (std::size_t i = 0; i < part; ++i) {
            level[begin + i] = wide_px[i] < end_px ? level_in(static_cast<std::size_t>(cell[i]), wide_px[i])
                                                   : nearest_level(wide_px[i]);
        }
    }
}

}  // namespace postlens
