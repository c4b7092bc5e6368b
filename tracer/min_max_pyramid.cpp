#include "tracer/min_max_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace postlens {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

}  // namespace

MinMaxPyramid::MinMaxPyramid(int x_begin, int y_begin, int width, int height,
                             const std::vector<float>& values)
    : x_begin_(x_begin), y_begin_(y_begin) {
    Level first{width, height, {}};
    first.ranges.reserve(values.size());
    for (const float v : values) {
        first.ranges.push_back(std::isnan(v) ? Range{infinity, -infinity} : Range{v, v});
    }
    levels_.push_back(std::move(first));
    while (levels_.back().width > 1 || levels_.back().height > 1) {
        const Level& below = levels_.back();
        Level above{(below.width + 1) / 2, (below.height + 1) / 2, {}};
        above.ranges.assign(static_cast<std::size_t>(above.width) * static_cast<std::size_t>(above.height),
                            {infinity, -infinity});
        for (int y = 0; y < below.height; ++y) {
            for (int x = 0; x < below.width; ++x) {
                const Range& from =
                    below.ranges[static_cast<std::size_t>(y) * static_cast<std::size_t>(below.width) +
                                 static_cast<std::size_t>(x)];
                Range& to =
                    above.ranges[static_cast<std::size_t>(y / 2) * static_cast<std::size_t>(above.width) +
                                 static_cast<std::size_t>(x / 2)];
                to.low = std::min(to.low, from.low);
                to.high = std::max(to.high, from.high);
            }
        }
        levels_.push_back(std::move(above));
    }
}

// Of squares whose diagonal is at most an eighth of the radius.
int MinMaxPyramid::coarse_level(double radius) const {
    const int highest = static_cast<int>(levels_.size()) - 1;
    int level = 0;
    while (level < highest && std::sqrt(2.0) * (2 << level) <= radius / 8) ++level;
    return level;
}

// Depth first. `visit(range, level, distance2)` says whether to go into a square, and is asked about single
// values as well; `distance2()` is the squared distance of `at` from the nearest of its whole coordinates.
template <typename Visit>
void MinMaxPyramid::descend(const glm::dvec2& at, const Visit& visit) const {
    struct Square {
        int level, x, y;
    };
    // A square leaves at most three of its brothers behind on each of at most 31 levels.
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): clearing it costs as much as a search
    std::array<Square, 128> open;
    std::size_t count = 0;
    open[count++] = {static_cast<int>(levels_.size()) - 1, 0, 0};
    const double x = at.x - x_begin_, y = at.y - y_begin_;
    while (count > 0) {
        const Square s = open[--count];
        const Level& level = levels_[static_cast<std::size_t>(s.level)];
        const Range& range =
            level.ranges[static_cast<std::size_t>(s.y) * static_cast<std::size_t>(level.width) +
                         static_cast<std::size_t>(s.x)];
        const auto distance2 = [&] {
            const int size = 1 << s.level;
            const double left = s.x * size, top = s.y * size;
            const double dx = std::max(std::max(left - x, x - (left + size - 1)), 0.0),
                         dy = std::max(std::max(top - y, y - (top + size - 1)), 0.0);
            return dx * dx + dy * dy;
        };
        if (!visit(range, s.level, distance2) || s.level == 0) continue;
        const Level& below = levels_[static_cast<std::size_t>(s.level - 1)];
        for (int cy = 2 * s.y; cy < std::min(2 * s.y + 2, below.height); ++cy) {
            for (int cx = 2 * s.x; cx < std::min(2 * s.x + 2, below.width); ++cx) {
                open[count++] = {s.level - 1, cx, cy};
            }
        }
    }
}

bool MinMaxPyramid::any_in(const Cone& cone, int level) const {
    const double radius2 = cone.radius * cone.radius, slope2 = cone.slope * cone.slope;
    bool found = false;
    descend(cone.at, [&](const Range& range, int at_level, const auto& distance2) {
        const double under = cone.top - static_cast<double>(range.low);
        if (found || !(under >= cone.least)) return false;
        const double d2 = distance2();
        if (d2 > radius2 || under * under < slope2 * d2) return false;
        found = at_level <= level;
        return !found;
    });
    return found;
}

bool MinMaxPyramid::any_in(const Cone& cone) const {
    return any_in(cone, 0);
}

bool MinMaxPyramid::maybe_any_in(const Cone& cone) const {
    return any_in(cone, coarse_level(cone.radius));
}

double MinMaxPyramid::greatest(const glm::dvec2& at, double radius, double floor) const {
    const int level = coarse_level(radius);
    double best = floor;
    descend(at, [&](const Range& range, int at_level, const auto& distance2) {
        const auto high = static_cast<double>(range.high);
        if (!(high > best) || distance2() > radius * radius) return false;
        if (at_level <= level) best = high;
        return at_level > level;
    });
    return best;
}

}  // namespace postlens
