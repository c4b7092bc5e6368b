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

    /// A region in which low values are searched for, around the position `at`. It contains the values at
    /// distances d up to `radius` that are at most top - max(least, slope * d).
    struct Cone {
        glm::dvec2 at{0};
        double radius = 0, top = 0, least = 0, slope = 0;  ///< all but `top` >= 0
    };
    /// A square of positions in the pyramid, at which a search for a low value ended. It can be passed to the
    /// next search, which then tests this square first, because nearby searches often end in the same square.
    /// A hint from the search of another pyramid is allowed, too.
    struct Hint {
        int level = 0, x = 0, y = 0;
    };
    /// Returns whether the cone contains any value.
    [[nodiscard]] bool any_in(const Cone& cone, Hint& hint) const;
    [[nodiscard]] bool any_in(const Cone& cone) const;
    /// Returns true if the pyramid has a value in the region `cone`. Is faster than any_in for cones of a
    /// large radius, but less exact: the result may also be true because of values whose distance from the
    /// position `cone.at` is up to 9/8 of the radius.
    [[nodiscard]] bool maybe_any_in(const Cone& cone, Hint& hint) const;
    [[nodiscard]] bool maybe_any_in(const Cone& cone) const;
    /// Returns true if the square `hint` of the pyramid, in which an earlier search ended, certainly has a
    /// value in the region `cone`. Then any_in (or, for hint_maybe_in, maybe_any_in) would return true, too,
    /// so the search can be omitted. If the result is false, the region may still contain a value elsewhere.
    [[nodiscard]] bool hint_in(const Cone& cone, const Hint& hint) const { return at_hint(cone, 0, hint); }
    [[nodiscard]] bool hint_maybe_in(const Cone& cone, const Hint& hint) const {
        return at_hint(cone, coarse_level(cone.radius), hint);
    }
    /// Returns the least of all values, or infinity if there are no values.
    [[nodiscard]] double least() const { return static_cast<double>(levels_.back().ranges.front().low); }
    /// Returns the greatest value at distances up to `radius` from the position `at`. If all these values are
    /// less than `floor`, returns `floor`. Values at distances up to 9/8 of the radius may also be included,
    /// because only squares of the pyramid are tested, not single values.
    [[nodiscard]] double greatest(const glm::dvec2& at, double radius, double floor) const;
    /// Returns an upper bound of greatest(at, radius, floor). It is faster to compute, because only a few
    /// squares of the pyramid are read.
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
    /// Returns the columns and rows of the squares, on the pyramid level `level`, that overlap the bounding
    /// box of the circle of radius `radius` around `at`. If the box lies outside the pyramid, returns the
    /// nearest squares.
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
