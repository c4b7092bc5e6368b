#include "focus/level_table.h"

#include <algorithm>
#include <cstddef>

#include "core/multiversion.h"

namespace postlens {
namespace {

constexpr double even_px = LevelTable::even_diameter_px;
/// Just under half a pixel of diameter between levels, so that no CoC is off by a quarter of one.
constexpr double step_diameter_px = 0.49;
/// That would make a small disc, and what it shows of a highlight, a fifth brighter or darker: a fiftieth of
/// the diameter between its levels, and no less than an eighth of a pixel.
constexpr double small_step_px = 0.125, small_step_share = 0.02;
constexpr double smallest_px = small_step_px / small_step_share,
                 small_px = step_diameter_px / small_step_share;
/// Less is no blur: the picture of records is softer by as much where cells of different sizes meet, and came
/// out worse with both (47.0 to 45.3 dB at f/64, where circles are up to 0.3 px wide).
constexpr double sharp_below_px = 0.4;
/// Levels per factor e of the CoC beyond even_px.
constexpr double levels_per_e = 500;
const double smallest_levels = smallest_px / small_step_px,
             small_levels = smallest_levels + std::log(small_px / smallest_px) / small_step_share,
             even_levels = small_levels + (even_px - small_px) / step_diameter_px;

/// Steps from a diameter of 0 on.
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

/// What levels_of looks up.
struct Cells {
    const double* begin_px;
    const std::int32_t *before, *step;
    int per_px;
    double end_px;
};

/// True where circles beyond the cells are among them, whose levels are still to be found.
POSTLENS_MULTIVERSION
bool look_up(const Cells& cells, const FocusGeometry& geometry, const double* __restrict inverse_depth_per_m,
             std::size_t count, std::uint32_t* __restrict level) {
    const Cells c = cells;
    const FocusGeometry g = geometry;
    std::uint32_t beyond = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double wide_px = std::abs(g.coc_diameter_px(inverse_depth_per_m[i]));
        const bool inside = wide_px < c.end_px;
        const auto cell = static_cast<std::int32_t>((inside ? wide_px : 0.0) * c.per_px);
        const std::int32_t begun = wide_px < c.begin_px[cell] ? 0 : -1;
        level[i] = static_cast<std::uint32_t>(c.before[cell] + (c.step[cell] & begun));
        beyond |= inside ? 0U : 1U;
    }
    return beyond != 0;
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
    const Cells found{begin_px_.data(), before_.data(), step_.data(), cells_per_px, end_px};
    if (!look_up(found, geometry, inverse_depth_per_m, count, level)) return;
    for (std::size_t i = 0; i < count; ++i)
        level[i] = level_of(geometry.coc_diameter_px(inverse_depth_per_m[i]));
}

}  // namespace postlens
