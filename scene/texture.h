// Textures: colours that depend on the position on a surface.
// A checker uses the position in object space or (u, v), and an image uses (u, v).
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "scene/texel_ranges.h"

namespace postlens {

/// A checker pattern. The colour is `even` if the sum of the cell indices along all axes is even, otherwise
/// `odd`. The index for coordinate c is floor((c - offset) / size), without rounding error.
struct Checker {
    int dimensions = 3;  ///< 3: cells in object-space x, y, z; 2: cells in u, v
    /// for each axis, the edge length of a cell of the checkerboard; in metres in object space or, for a
    /// pattern in (u, v), in units of u and v; infinite if the pattern is constant along the axis
    glm::dvec3 size{1};
    glm::dvec3 offset{0};
    glm::dvec3 even{1}, odd{0};
};

/// An image over the unit square of (u, v), where u points right and v points up.
/// - u: repeated unless `clamp_u` is set
/// - v: repeated if `wrap_v` is set or `repeat.y` is not 1, otherwise clamped, so that colours at a sphere's
///   two poles do not mix
struct ImageTexture {
    int width = 0, height = 0;
    std::vector<float> rgb;  ///< scene-linear, top row first
    glm::dvec2 repeat{1};    ///< number of repetitions in the unit square
    bool nearest = false;    ///< if false, texels are interpolated bilinearly
    bool clamp_u = false;    ///< clamps u to the first and last column
    bool wrap_v = false;
};

/// Returns floor((c - offset) / size) without rounding error, or 0 for an infinite size.
/// c and offset must be finite, and size above 0.
[[nodiscard]] double checker_cell(double c, double offset, double size);

class Texture {
  public:
    explicit Texture(Checker checker);
    explicit Texture(ImageTexture image);
    /// Returns the colour at a surface point: `object` in object space, m, and texture coordinates `uv`.
    [[nodiscard]] glm::dvec3 colour(const glm::dvec3& object, const glm::dvec2& uv) const;
    /// Returns true if the function `colour` uses the surface's texture coordinates `uv`, and false if it
    /// uses the position in object space.
    [[nodiscard]] bool uses_uv() const { return is_image_ || checker_.dimensions == 2; }
    /// Returns the greatest channel value that `colour` can return.
    [[nodiscard]] double maximum() const { return maximum_; }
    /// Returns the coordinates that determine the colour: uv, or the position in object space.
    [[nodiscard]] glm::dvec3 place(const glm::dvec3& object, const glm::dvec2& uv) const {
        return uses_uv() ? glm::dvec3(uv, 0) : object;
    }
    /// Returns the colour at a texture position (see `place`).
    [[nodiscard]] glm::dvec3 colour_at(const glm::dvec3& place) const {
        return colour(place, glm::dvec2(place));
    }
    /// Returns the range of all colours of the texture in the box from `low` to `high`, in texture positions
    /// (see `place`). If these differ by half an image or more, there is probably a seam of the texture
    /// between them. Then only the colours of the two corners are included.
    [[nodiscard]] ColourRange range(const glm::dvec3& low, const glm::dvec3& high) const;

  private:
    bool is_image_ = false;
    Checker checker_;
    ImageTexture image_;
    TexelRanges ranges_;
    double maximum_ = 0;
};

}  // namespace postlens
