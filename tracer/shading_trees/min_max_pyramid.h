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

    /// A region in which low values are searched for. A value at distance d from the position `at` is in the
    /// region if d <= radius and the value is at most top - max(least, slope * d).
    struct Cone {
        glm::dvec2 at{0};
        double radius = 0, top = 0, least = 0, slope = 0;  ///< all but `top` >= 0
    };
    /// The square of the pyramid at which a search for a value ended. The next search tests this square
    /// first, because nearby searches often end in the same square. A hint from another pyramid is allowed.
    struct Hint {
        int level = 0, x = 0, y = 0;
    };
    /// Returns whether the cone contains any value.
    [[nodiscard]] bool any_in(const Cone& cone, Hint& hint) const;
    [[nodiscard]] bool any_in(const Cone& cone) const;
    /// Returns whether the cone contains any value. Faster than any_in for wide cones, because values up to
    /// 9/8 of the cone's radius away may also count.
    [[nodiscard]] bool maybe_any_in(const Cone& cone, Hint& hint) const;
    [[nodiscard]] bool maybe_any_in(const Cone& cone) const;
    /// Tests only the square `hint` of the pyramid, in which an earlier search ended. If the result is true,
    /// a full search by any_in or maybe_any_in would return true, too.
    [[nodiscard]] bool hint_in(const Cone& cone, const Hint& hint) const { return at_hint(cone, 0, hint); }
    [[nodiscard]] bool hint_maybe_in(const Cone& cone, const Hint& hint) const {
        return at_hint(cone, coarse_level(cone.radius), hint);
    }
    /// Returns the least of all values, or infinity if there are no values.
    [[nodiscard]] double least() const { return static_cast<double>(levels_.back().ranges.front().low); }
    /// Returns the greatest value of the pyramid at distances up to `radius`, px, from `at`, or `floor` if
    /// all these values are less. May include values up to 9/8 of the radius away.
    [[nodiscard]] double greatest(const glm::dvec2& at, double radius, double floor) const;
    /// Returns an upper bound of greatest(at, radius, floor), the greatest value near `at`. It is faster to
    /// compute, because only a few squares of the pyramid are read.
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
    /// Returns the lowest level of the pyramid whose squares are at least `px` wide, or the highest level if
    /// all squares are narrower.
    [[nodiscard]] int level_of_width(double px) const;
    /// Returns the squares of the pyramid level `level` that overlap the bounding box of the circle around
    /// `at`, or the nearest squares if none do.
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
