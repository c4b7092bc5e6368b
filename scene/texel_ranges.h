// Computes the range of colours in a rectangle of an image without reading all its texels.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

namespace postlens {

/// Least and greatest value of each colour channel among colours that are passed to `add`. Before the first
/// colour, the range is empty.
struct ColourRange {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    void add(const glm::dvec3& colour) {
        low = glm::min(low, colour);
        high = glm::max(high, colour);
    }
};

/// The least and greatest value of each colour channel in squares of texels. The edges of these squares are
/// 4, 8, 16, ... texels long.
class TexelRanges {
  public:
    TexelRanges() = default;
    /// Computes the least and the greatest value of each colour channel in squares of texels. `rgb` holds the
    /// colours of the `width` x `height` texels. The constructor keeps no reference to it.
    TexelRanges(std::span<const float> rgb, int width, int height);

    /// Returns the least and the greatest value of each colour channel among the texels in columns x_first to
    /// x_last and rows y_first to y_last. `rgb` must be the array that was passed to the constructor. With
    /// `wrap_x` and `wrap_y`, the image is repeated beyond its borders. Otherwise, its border texels are used
    /// there.
    ///
    /// A rectangle with more than 9 texels along an edge is covered by precomputed squares, whose positions
    /// are fixed. Therefore, they may extend beyond it by up to two fifths of its longer edge, and the range
    /// may be too wide.
    [[nodiscard]] ColourRange of(std::span<const float> rgb, double x_first, double x_last, double y_first,
                                 double y_last, bool wrap_x, bool wrap_y) const;

  private:
    struct Level {
        int width = 0, height = 0;
        std::vector<std::array<float, 6>> squares;  ///< least r, g, b; greatest r, g, b
    };
    int width_ = 0, height_ = 0;
    std::vector<Level> levels_;
};

}  // namespace postlens
