// A raster of values with a fast search around a position for values that are below a limit. The limit falls
// with the distance from the position, as a cone does.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace postlens {

/// Values at integer positions, and the least and the greatest value in squares of 2, 4, 8, ... positions a
/// side.
class MinMaxPyramid {
  public:
    /// The value at (x, y) is values[(y - y_begin) * width + x - x_begin]; NaN: none.
    MinMaxPyramid(int x_begin, int y_begin, int width, int height, const std::vector<float>& values);

    /// A cone around the position `at`. It selects the values v at a distance d <= `radius` from `at` for
    /// which top - v >= least and top - v >= slope d.
    struct Cone {
        glm::dvec2 at{0};
        double radius = 0, top = 0, least = 0, slope = 0;  ///< all but `top` >= 0
    };
    /// The square or value that an earlier search found. A search tests this square first, because a cone
    /// nearby probably selects the same values. The hint may come from another pyramid.
    struct Hint {
        int level = 0, x = 0, y = 0;
    };
    /// Whether the cone selects any value.
    [[nodiscard]] bool any_in(const Cone& cone, Hint& hint) const;
    [[nodiscard]] bool any_in(const Cone& cone) const;
    /// Like any_in, but several times faster for wide cones. The result may also be true because of a value
    /// that lies outside of the cone by up to an eighth of the radius. The result does not depend on the
    /// hint.
    [[nodiscard]] bool maybe_any_in(const Cone& cone, Hint& hint) const;
    [[nodiscard]] bool maybe_any_in(const Cone& cone) const;
    /// The least of all values; infinity if there is none.
    [[nodiscard]] double least() const { return static_cast<double>(levels_.back().ranges.front().low); }
    /// The greatest value within `radius` of `at`, or a greater value that lies within 9/8 of the radius. If
    /// all values are below `floor`, the result is `floor`.
    [[nodiscard]] double greatest(const glm::dvec2& at, double radius, double floor) const;
    /// An upper bound of greatest(at, radius, floor), from a few squares.
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
    /// The lowest level whose squares are at least `px` wide, or else the highest level.
    [[nodiscard]] int level_of_width(double px) const;
    /// The squares of a level that overlap the bounding box of a circle, or else the nearest squares.
    [[nodiscard]] Squares squares_around(const glm::dvec2& at, double radius, int level) const;
    [[nodiscard]] bool any_in(const Cone& cone, int level, Hint& hint) const;
    enum class Next : std::uint8_t {
        into,
        past,
        end
    };  ///< descend into a square, skip it, or end the search
    template <typename Visit, typename Promise, typename Keeps>
    void descend(const glm::dvec2& at, double radius, const Visit& visit, const Promise& promise,
                 const Keeps& keeps) const;

    int x_begin_, y_begin_;
    std::vector<Level> levels_;  ///< from the single values up to one square over all
};

}  // namespace postlens
