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

// Depth first, within `radius` of `at`. `visit(range, level, distance2)` says what to do with a square, and
// is asked about single values as well; `distance2()` is the squared distance of `at` from the nearest of its
// whole coordinates. Of brothers, that with the greatest `promise(range)` comes first; where `keeps(promise)`
// no longer holds when its turn comes, a square is passed over.
template <typename Visit, typename Promise, typename Keeps>
void MinMaxPyramid::descend(const glm::dvec2& at, double radius, const Visit& visit, const Promise& promise,
                            const Keeps& keeps) const {
    struct Square {
        int level, x, y;
        float promise;
    };
    if (!(radius >= 0)) return;  // not a number
    // A square leaves at most three of its brothers behind on each of at most 31 levels.
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): clearing it costs as much as a search
    std::array<Square, 128> open;
    std::size_t count = 0;
    const double x = at.x - x_begin_, y = at.y - y_begin_;
    // False where the search is over.
    const auto meet = [&](int at_level, int x_first, int x_last, int y_first, int y_last) {
        const Level& level = levels_[static_cast<std::size_t>(at_level)];
        const int size = 1 << at_level;
        const std::size_t begin = count;
        for (int sy = y_first; sy <= y_last; ++sy) {
            for (int sx = x_first; sx <= x_last; ++sx) {
                const Range& range =
                    level.ranges[static_cast<std::size_t>(sy) * static_cast<std::size_t>(level.width) +
                                 static_cast<std::size_t>(sx)];
                const auto distance2 = [&] {
                    const double left = sx * size, top = sy * size;
                    const double dx = std::max(std::max(left - x, x - (left + size - 1)), 0.0),
                                 dy = std::max(std::max(top - y, y - (top + size - 1)), 0.0);
                    return dx * dx + dy * dy;
                };
                const Next next = visit(range, at_level, distance2);
                if (next == Next::end) return false;
                if (next == Next::into && at_level > 0) open[count++] = {at_level, sx, sy, promise(range)};
            }
        }
        for (std::size_t i = begin; i + 1 < count; ++i)
            if (open[i].promise > open[count - 1].promise) std::swap(open[i], open[count - 1]);
        return true;
    };
    // From the squares as wide as the circle, of which it meets two by two at most: most circles are small,
    // and most of the way down from the top would be to find out where they are.
    const int highest = static_cast<int>(levels_.size()) - 1;
    int top = 0;
    while (top < highest && (1 << top) < 2 * radius + 1) ++top;
    const Level& first = levels_[static_cast<std::size_t>(top)];
    const auto square_of = [&](double place, int squares) {
        return static_cast<int>(std::clamp(std::floor(place / (1 << top)), 0.0, squares - 1.0));
    };
    bool going = meet(top, square_of(x - radius, first.width), square_of(x + radius, first.width),
                      square_of(y - radius, first.height), square_of(y + radius, first.height));
    while (going && count > 0) {
        const Square s = open[--count];
        if (!keeps(s.promise)) continue;
        const Level& below = levels_[static_cast<std::size_t>(s.level - 1)];
        going = meet(s.level - 1, 2 * s.x, std::min(2 * s.x + 1, below.width - 1), 2 * s.y,
                     std::min(2 * s.y + 1, below.height - 1));
    }
}

bool MinMaxPyramid::any_in(const Cone& cone, int level) const {
    const double radius2 = cone.radius * cone.radius, slope2 = cone.slope * cone.slope;
    bool found = false;
    descend(
        cone.at, cone.radius,
        [&](const Range& range, int at_level, const auto& distance2) {
            const double under = cone.top - static_cast<double>(range.low);
            if (!(under >= cone.least)) return Next::past;
            const double d2 = distance2();
            if (d2 > radius2 || under * under < slope2 * d2) return Next::past;
            found = at_level <= level;
            return found ? Next::end : Next::into;
        },
        [](const Range& range) { return -range.low; }, [](float) { return true; });
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
    descend(
        at, radius,
        [&](const Range& range, int at_level, const auto& distance2) {
            const auto high = static_cast<double>(range.high);
            if (!(high > best) || distance2() > radius * radius) return Next::past;
            if (at_level <= level) best = high;
            return at_level > level ? Next::into : Next::past;
        },
        [](const Range& range) { return range.high; },
        [&](float high) { return static_cast<double>(high) > best; });
    return best;
}

}  // namespace postlens
