// A raster of numbers that tells quickly whether something lower than a cone lies near a place.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace postlens {

/// Values on whole coordinates, and over them squares of 2, 4, 8, ... with the least and the greatest inside.
class MinMaxPyramid {
  public:
    /// Value (x, y) of the raster is values[(y - y_begin) * width + x - x_begin]; NaN: nothing is there.
    MinMaxPyramid(int x_begin, int y_begin, int width, int height, const std::vector<float>& values);

    /// Values at a distance d <= `radius` of `at` that lie under `top` by at least `least` and by `slope` d.
    struct Cone {
        glm::dvec2 at{0};
        double radius = 0, top = 0, least = 0, slope = 0;  ///< 0 or more but for `top`
    };
    /// A square, or a single value, that some cone had: most likely the next one nearby has it as well, which
    /// is seen without a search. Of this pyramid or of any other.
    struct Hint {
        int level = 0, x = 0, y = 0;
    };
    /// Whether there is any.
    [[nodiscard]] bool any_in(const Cone& cone, Hint& hint) const;
    [[nodiscard]] bool any_in(const Cone& cone) const;
    /// The same several times faster for wide cones; true also for some values that miss by an eighth of
    /// the radius. Whatever the hint.
    [[nodiscard]] bool maybe_any_in(const Cone& cone, Hint& hint) const;
    [[nodiscard]] bool maybe_any_in(const Cone& cone) const;
    /// Of all values; infinity where there is none.
    [[nodiscard]] double least() const { return static_cast<double>(levels_.back().ranges.front().low); }
    /// The greatest value within `radius` of `at`, or a greater one within nine eighths of it; `floor` where
    /// none is greater.
    [[nodiscard]] double greatest(const glm::dvec2& at, double radius, double floor) const;
    /// No less than that, told by a few squares.
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
    /// The lowest whose squares are at least `px` wide, or else the highest.
    [[nodiscard]] int level_of_width(double px) const;
    /// Of a level, those that the box around a circle meets, or else the nearest.
    [[nodiscard]] Squares squares_around(const glm::dvec2& at, double radius, int level) const;
    [[nodiscard]] bool any_in(const Cone& cone, int level, Hint& hint) const;
    enum class Next : std::uint8_t { into, past, end };  ///< of a square: look inside, do not, or stop
    template <typename Visit, typename Promise, typename Keeps>
    void descend(const glm::dvec2& at, double radius, const Visit& visit, const Promise& promise,
                 const Keeps& keeps) const;

    int x_begin_, y_begin_;
    std::vector<Level> levels_;  ///< from the values up to a single square
};

}  // namespace postlens
