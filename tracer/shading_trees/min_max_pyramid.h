// A raster with the minima and maxima of ever larger squares, to find low values near a position quickly.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace postlens {

/// Values at integer positions, and the least and greatest value in squares of 2 x 2, 4 x 4, ... positions.
class MinMaxPyramid {
  public:
    /// The value at position (x, y) is values[(y - y_begin) * width + x - x_begin]. NaN means no value.
    MinMaxPyramid(int x_begin, int y_begin, int width, int height, const std::vector<float>& values);

    /// Describes a search for low values of the pyramid, around the position `at`. A value at the distance d
    /// from this position is found if d is at most `radius` and the value is at most `top` - max(`least`,
    /// `slope` * d). So a value must lie below `top` by at least `least`, and farther away by even more.
    struct Cone {
        glm::dvec2 at{0};
        double radius = 0, top = 0, least = 0, slope = 0;  ///< all but `top` >= 0
    };
    /// Remembers where a search for a low value ended: at the square in column x and row y of the pyramid's
    /// level `level`, which has squares of 2^level x 2^level values. The next search can test this square
    /// first, because searches at neighbouring positions often end in the same square. A hint from another
    /// pyramid is allowed, too.
    struct Hint {
        int level = 0, x = 0, y = 0;
    };
    /// Returns whether the cone contains any value.
    [[nodiscard]] bool any_in(const Cone& cone, Hint& hint) const;
    [[nodiscard]] bool any_in(const Cone& cone) const;
    /// Returns true if the pyramid contains a value that the search `cone` looks for. It is faster than
    /// any_in if the search radius, `cone.radius`, is large, but less exact. Because it tests whole squares
    /// of values, it may also return true for a value slightly farther away, up to 9/8 of the radius.
    [[nodiscard]] bool maybe_any_in(const Cone& cone, Hint& hint) const;
    [[nodiscard]] bool maybe_any_in(const Cone& cone) const;
    /// Returns true if the square `hint` of the pyramid, at which an earlier search ended, certainly contains
    /// a value that the search `cone` looks for. Then any_in would return true, too, so that the search can
    /// be omitted. (For hint_maybe_in, this holds for maybe_any_in.) If the result is false, such a value may
    /// still exist elsewhere.
    [[nodiscard]] bool hint_in(const Cone& cone, const Hint& hint) const { return at_hint(cone, 0, hint); }
    [[nodiscard]] bool hint_maybe_in(const Cone& cone, const Hint& hint) const {
        return at_hint(cone, coarse_level(cone.radius), hint);
    }
    /// Returns the least of all values, or infinity if there are no values.
    [[nodiscard]] double least() const { return static_cast<double>(levels_.back().ranges.front().low); }
    /// Returns the greatest value of the pyramid at positions within `radius` of the position `at`, or
    /// `floor` if this is greater. Some values at distances up to 9/8 of the radius may be included, because
    /// whole squares of values are tested instead of single values.
    [[nodiscard]] double greatest(const glm::dvec2& at, double radius, double floor) const;
    /// Returns an upper bound of the greatest value within `radius` of the position `at`, or `floor` if this
    /// is greater. It is faster than greatest(), which searches for the value itself. Here, only the few
    /// squares of the pyramid are read that overlap the circle and are about as wide as `radius`.
    [[nodiscard]] double at_most(const glm::dvec2& at, double radius, double floor) const;

  private:
    struct Range {
        float low, high;
    };
    struct Level {
        int width = 0, height = 0;
        std::vector<Range> ranges;
    };
    struct Squares {
        int x_first, x_last, y_first, y_last;
    };
    [[nodiscard]] int coarse_level(double radius) const;
    /// Level k of the pyramid stores the least and the greatest value in each square of 2^k x 2^k positions.
    /// Returns the lowest level whose squares are at least `px` wide, or the highest level if all squares are
    /// narrower.
    [[nodiscard]] int level_of_width(double px) const;
    /// Returns which squares of a level of the pyramid a search must visit: the columns and rows of the
    /// squares that overlap the bounding box of the circle of radius `radius` around `at`. On level k, a
    /// square covers 2^k x 2^k values. If the box lies outside the pyramid, returns the nearest squares.
    [[nodiscard]] Squares squares_around(const glm::dvec2& at, double radius, int level) const;
    [[nodiscard]] bool any_in(const Cone& cone, int level, Hint& hint) const;
    [[nodiscard]] bool at_hint(const Cone& cone, int level, const Hint& hint) const;
    enum class Next : std::uint8_t {
        into,
        past,
        end
    };  ///< descend into a square, skip it, or end the search
    template <typename Visit, typename Promise, typename Keeps>
    void descend(const glm::dvec2& at, double radius, const Visit& visit, const Promise& promise,
                 const Keeps& keeps) const;

    int x_begin_, y_begin_;
    std::vector<Level> levels_;  ///< from single values up to one square for all values
};

}  // namespace postlens
