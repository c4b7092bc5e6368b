// Searches parts of pixels for the light of a bright surface, with traced rays through a grid of squares.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "core/sample_hash.h"
#include "reproject/sight_rays.h"

namespace postlens {

/// The longer side of an area that is searched is divided into edge_squares squares, and each square is
/// searched by square_rays x square_rays rays.
inline constexpr int edge_squares = 8, square_rays = 2, rays_per_square = square_rays * square_rays;

using Pixel = std::pair<int, int>;  ///< row, column

/// A rectangle within a pixel in which traced rays measure the area of a highlight. `begin` and `end` are its
/// upper left and its lower right corner, in px from the pixel's upper left corner.
struct EdgeArea {
    Pixel pixel;
    Pixel recorded = pixel;  ///< a pixel with a record of the light in it or in one of its eight neighbours
    int divided = 1;         ///< into how many squares those at the light's edge are divided, along each axis
    /// Whether the records are closer together than the rays, unless squares are divided.
    bool has_fine_records = false;
    glm::dvec2 begin{0}, end{1};

    [[nodiscard]] double square_px() const {
        return std::max(end.x - begin.x, end.y - begin.y) / edge_squares;
    }
    /// Number of squares along each axis, after in_squares().
    [[nodiscard]] glm::ivec2 squares() const { return glm::ivec2(glm::round((end - begin) / square_px())); }
    /// Returns the area, widened within the pixel so that it consists of whole squares.
    [[nodiscard]] EdgeArea in_squares() const {
        EdgeArea out = *this;
        const double side = square_px();
        for (int axis = 0; axis < 2; ++axis) {
            const double wanted = std::ceil((end[axis] - begin[axis]) / side - 1e-6) * side;
            if (wanted <= end[axis] - begin[axis] + 1e-6 * side) continue;
            out.end[axis] = begin[axis] + wanted < 1 - 1e-9 ? begin[axis] + wanted : 1;
            out.begin[axis] = out.end[axis] - wanted > 1e-9 ? out.end[axis] - wanted : 0;
        }
        return out;
    }
};

/// A square within an area that rays search for light, and the light that they find.
struct Square {
    glm::dvec2 begin{0};  ///< upper left corner, px from the pixel's upper left corner
    std::array<float, 3> rgb{};
    glm::dvec2 at{0};  ///< sum of the positions of the rays that find light
    int found = 0;     ///< number of these rays
};

/// Searches squares of one pixel for the light of one surface.
class SquareSearch {
  public:
    SquareSearch(const NodeIdentity& node, const Pixel& pixel, const SightRays& rays,
                 const LightElsewhere& less)
        : node_(node),
          pixel_(pixel),
          rays_(rays),
          less_(less),
          seed_(mix64((std::uint64_t{static_cast<std::uint32_t>(pixel.first)} << 32U) |
                      static_cast<std::uint32_t>(pixel.second))) {}

    /// Traces rays through `squares`, which are `side_px` wide, and adds the light that they find.
    void search(std::vector<Square>& squares, double side_px);

  private:
    NodeIdentity node_;
    Pixel pixel_;
    const SightRays& rays_;
    const LightElsewhere& less_;
    std::uint64_t seed_;
};

/// The squares of an area, with a ring of squares around them.
class SquareGrid {
  public:
    SquareGrid(const EdgeArea& area, bool with_ring)
        : size_(area.squares()), side_px_(area.square_px()), area_(area), with_ring_(with_ring) {
        for (int y = -1; y <= size_.y; ++y) {
            for (int x = -1; x <= size_.x; ++x)
                squares_.push_back({.begin = area.begin + side_px_ * glm::dvec2(x, y)});
        }
        divided_.resize(squares_.size());
    }
    [[nodiscard]] glm::ivec2 size() const { return size_; }
    [[nodiscard]] double side_px() const { return side_px_; }
    [[nodiscard]] Square& at(int x, int y) { return squares_[index(x, y)]; }
    [[nodiscard]] bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < size_.x && y < size_.y; }
    /// The smaller squares into which a square is divided; empty if it is not.
    [[nodiscard]] std::vector<Square>& divided(int x, int y) { return divided_[index(x, y)]; }

    /// Searches all squares, and the ring if there is one.
    void search(SquareSearch& by);

    /// Divides the squares at the edge of the light, and searches them again: those of which the rays find
    /// light in a part only, those beside squares with another result, and those for which `has_record` is
    /// true. A narrow strip of light may continue into squares in which no ray met it. So squares beside
    /// those are divided too.
    void divide(SquareSearch& by, const std::function<bool(const Square&)>& has_record);

    /// Returns whether light touches the left border (`side` = -1) or right border (1) of the area if `axis`
    /// is 0, or the upper or lower border if it is 1.
    [[nodiscard]] bool touches(int axis, int side);

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>((y + 1) * (size_.x + 2) + x + 1);
    }
    [[nodiscard]] bool is_edge(int x, int y);

    glm::ivec2 size_;
    double side_px_;
    EdgeArea area_;
    bool with_ring_;
    std::vector<Square> squares_;
    std::vector<std::vector<Square>> divided_;
};

}  // namespace postlens
