#include "tracer/shading_trees/min_max_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace postlens {
namespace {

constexpr float no_value = std::numeric_limits<float>::infinity();

/// Returns the squared distance from (x, y) to the nearest pixel in a square of `size` x `size` pixels.
/// Pixels have integer positions, and the first pixel of the square is (square_x, square_y) * size.
double distance2_of(double x, double y, int square_x, int square_y, double size) {
    const double left = square_x * size, top = square_y * size;
    const double dx = std::max(std::max(left - x, x - (left + size - 1)), 0.0),
                 dy = std::max(std::max(top - y, y - (top + size - 1)), 0.0);
    return dx * dx + dy * dy;
}

template <typename Distance2>
bool may_contain(const MinMaxPyramid::Cone& cone, float low, const Distance2& distance2) {
    const double under = cone.top - static_cast<double>(low);
    if (!(under >= cone.least)) return false;
    const double d2 = distance2();
    return d2 <= cone.radius * cone.radius && under * under >= cone.slope * cone.slope * d2;
}

}  // namespace

MinMaxPyramid::MinMaxPyramid(int x_begin, int y_begin, int width, int height,
                             const std::vector<float>& values)
    : x_begin_(x_begin), y_begin_(y_begin) {
    Level first{width, height, {}};
    first.ranges.reserve(values.size());
    for (const float v : values) {
        first.ranges.push_back(std::isnan(v) ? Range{no_value, -no_value} : Range{v, v});
    }
    levels_.push_back(std::move(first));
    while (levels_.back().width > 1 || levels_.back().height > 1) {
        const Level& below = levels_.back();
        Level above{(below.width + 1) / 2, (below.height + 1) / 2, {}};
        above.ranges.assign(static_cast<std::size_t>(above.width) * static_cast<std::size_t>(above.height),
                            {no_value, -no_value});
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

// Level k of the pyramid consists of squares of 2^k x 2^k positions. Returns the highest (coarsest) level
// whose squares have a diagonal of at most an eighth of the search radius `radius`.
int MinMaxPyramid::coarse_level(double radius) const {
    const int highest = static_cast<int>(levels_.size()) - 1;
    int level = 0;
    while (level < highest && std::sqrt(2.0) * (2 << level) <= radius / 8) ++level;
    return level;
}

int MinMaxPyramid::level_of_width(double px) const {
    const int highest = static_cast<int>(levels_.size()) - 1;
    int level = 0;
    while (level < highest && (1 << level) < px) ++level;
    return level;
}

MinMaxPyramid::Squares MinMaxPyramid::squares_around(const glm::dvec2& at, double radius, int level) const {
    const Level& of = levels_[static_cast<std::size_t>(level)];
    const double x = at.x - x_begin_, y = at.y - y_begin_, per_px = 1.0 / (1 << level);
    const auto square_of = [per_px](double place, int squares) {
        return static_cast<int>(std::clamp(place * per_px, 0.0, squares - 1.0));
    };
    return {square_of(x - radius, of.width), square_of(x + radius, of.width),
            square_of(y - radius, of.height), square_of(y + radius, of.height)};
}

// Searches the pyramid for values within `radius` of `at`, depth-first: from large squares of values down to
// level 0, whose squares are single values.
// - `visit(range, square, distance2)` decides whether to descend into a square, to skip it or to end the
//   search.
// - `promise(range)` rates a square by its least and greatest value. Of four squares, the one with the
//   highest rating is searched first.
// - `keeps(promise)` decides whether a square that had to wait is still searched.
// `distance2()` is the squared distance from `at` to the nearest integer position in the square.
template <typename Visit, typename Promise, typename Keeps>
void MinMaxPyramid::descend(const glm::dvec2& at, double radius, const Visit& visit, const Promise& promise,
                            const Keeps& keeps) const {
    struct Square {
        int level, x, y;
        float promise;
    };
    if (!(radius >= 0)) return;  // not a number
    // List of the squares of the pyramid that must still be searched. At the start, it contains at most 3 x 3
    // squares. In each step, one square is replaced by its four squares on the level below. There are at most
    // 31 levels below the first, so the list never contains more than 9 + 31 * 3 = 102 squares.
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): clearing it costs as much as a search
    std::array<Square, 128> open;
    std::size_t count = 0;
    const double x = at.x - x_begin_, y = at.y - y_begin_;
    const auto meet = [&](int at_level, int x_first, int x_last, int y_first, int y_last) {
        const Level& level = levels_[static_cast<std::size_t>(at_level)];
        const auto size = static_cast<double>(1 << at_level);
        const std::size_t begin = count;
        for (int sy = y_first; sy <= y_last; ++sy) {
            for (int sx = x_first; sx <= x_last; ++sx) {
                const Range& range =
                    level.ranges[static_cast<std::size_t>(sy) * static_cast<std::size_t>(level.width) +
                                 static_cast<std::size_t>(sx)];
                const auto distance2 = [&] { return distance2_of(x, y, sx, sy, size); };
                const Next next = visit(range, Hint{at_level, sx, sy}, distance2);
                if (next == Next::end) return false;
                if (next == Next::into && at_level > 0) open[count++] = {at_level, sx, sy, promise(range)};
            }
        }
        for (std::size_t i = begin; i + 1 < count; ++i)
            if (open[i].promise > open[count - 1].promise) std::swap(open[i], open[count - 1]);
        return true;
    };
    // The level of the pyramid on which the search starts. A level holds the least and the greatest value in
    // squares, which are twice as wide as on the level below. The search starts on the finest level whose
    // squares are at least as wide as `radius`, the search radius. There, the search circle overlaps at most
    // 3 x 3 squares. A search from the coarsest level down would take longer, because most circles are small.
    const int top = level_of_width(radius);
    const Squares around = squares_around(at, radius, top);
    bool going = meet(top, around.x_first, around.x_last, around.y_first, around.y_last);
    while (going && count > 0) {
        const Square s = open[--count];
        if (!keeps(s.promise)) continue;
        const Level& below = levels_[static_cast<std::size_t>(s.level - 1)];
        going = meet(s.level - 1, 2 * s.x, std::min(2 * s.x + 1, below.width - 1), 2 * s.y,
                     std::min(2 * s.y + 1, below.height - 1));
    }
}

bool MinMaxPyramid::at_hint(const Cone& cone, int level, const Hint& hint) const {
    if (hint.level > level || !(cone.radius >= 0)) return false;
    const Level& of = levels_[static_cast<std::size_t>(hint.level)];
    if (hint.x >= of.width || hint.y >= of.height) return false;
    return may_contain(cone,
                       of.ranges[static_cast<std::size_t>(hint.y) * static_cast<std::size_t>(of.width) +
                                 static_cast<std::size_t>(hint.x)]
                           .low,
                       [&] {
                           return distance2_of(cone.at.x - x_begin_, cone.at.y - y_begin_, hint.x, hint.y,
                                               1 << hint.level);
                       });
}

bool MinMaxPyramid::any_in(const Cone& cone, int level, Hint& hint) const {
    if (at_hint(cone, level, hint)) return true;
    bool found = false;
    descend(
        cone.at, cone.radius,
        [&](const Range& range, const Hint& square, const auto& distance2) {
            if (!may_contain(cone, range.low, distance2)) return Next::past;
            found = square.level <= level;
            if (found) hint = square;
            return found ? Next::end : Next::into;
        },
        [](const Range& range) { return -range.low; }, [](float) { return true; });
    return found;
}

bool MinMaxPyramid::any_in(const Cone& cone, Hint& hint) const {
    return any_in(cone, 0, hint);
}

bool MinMaxPyramid::any_in(const Cone& cone) const {
    Hint none;
    return any_in(cone, none);
}

bool MinMaxPyramid::maybe_any_in(const Cone& cone, Hint& hint) const {
    return any_in(cone, coarse_level(cone.radius), hint);
}

bool MinMaxPyramid::maybe_any_in(const Cone& cone) const {
    Hint none;
    return maybe_any_in(cone, none);
}

double MinMaxPyramid::greatest(const glm::dvec2& at, double radius, double floor) const {
    const int level = coarse_level(radius);
    double best = floor;
    descend(
        at, radius,
        [&](const Range& range, const Hint& square, const auto& distance2) {
            const auto high = static_cast<double>(range.high);
            if (!(high > best) || distance2() > radius * radius) return Next::past;
            if (square.level <= level) best = high;
            return square.level > level ? Next::into : Next::past;
        },
        [](const Range& range) { return range.high; },
        [&](float high) { return static_cast<double>(high) > best; });
    return best;
}

double MinMaxPyramid::at_most(const glm::dvec2& at, double radius, double floor) const {
    if (!(radius >= 0)) return floor;  // not a number
    const int number = level_of_width(radius);
    const Level& level = levels_[static_cast<std::size_t>(number)];
    const Squares around = squares_around(at, radius, number);
    double most = floor;
    for (int y = around.y_first; y <= around.y_last; ++y) {
        for (int x = around.x_first; x <= around.x_last; ++x) {
            const Range& range =
                level.ranges[static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) +
                             static_cast<std::size_t>(x)];
            most = std::max(most, static_cast<double>(range.high));
        }
    }
    return most;
}

}  // namespace postlens
