// Textures: colours over a surface, looked up in object space (checkers) or by (u, v) (images).
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "tracer/texel_ranges.h"

namespace postlens {

/// A checker in object space, exact at cell borders: the cell of coordinate c is floor((c - offset) / size),
/// borders belong to the higher cell. The cells whose coordinates add up to an even number are `even`.
struct Checker {
    int dimensions = 3;  ///< 3: object-space x, y, z; 2: u, v
    glm::dvec3 size{1};  ///< cell edge; object-space metres, or (u, v); infinite: no borders along that axis
    glm::dvec3 offset{0};
    glm::dvec3 even{1}, odd{0};
};

/// A picture over the unit square of (u, v): u to the right, v upwards. u wraps round unless `clamp_u`; v
/// wraps round where `wrap_v` is set or `repeat.y` is not 1, and stops at the first and last row otherwise (a
/// sphere's poles must not mix).
struct ImageTexture {
    int width = 0, height = 0;
    std::vector<float> rgb;  ///< scene-linear, top row first
    glm::dvec2 repeat{1};    ///< times over the unit square
    bool nearest = false;    ///< false: bilinear
    bool clamp_u = false;    ///< stop at the first and last column instead
    bool wrap_v = false;
};

/// floor((c - offset) / size) without rounding error, for finite c and offset and size > 0 (infinite: 0).
[[nodiscard]] double checker_cell(double c, double offset, double size);

class Texture {
  public:
    explicit Texture(Checker checker);
    explicit Texture(ImageTexture image);
    /// object: the hit in object space, m. uv: of the hit. A pure function.
    [[nodiscard]] glm::dvec3 colour(const glm::dvec3& object, const glm::dvec2& uv) const;
    /// Whether `colour` looks at uv; else at the object position.
    [[nodiscard]] bool uses_uv() const { return is_image_ || checker_.dimensions == 2; }
    /// The greatest channel value that `colour` can return; bounds what a surface can add.
    [[nodiscard]] double maximum() const { return maximum_; }
    /// What `colour` looks at: uv, or the object position.
    [[nodiscard]] glm::dvec3 place(const glm::dvec3& object, const glm::dvec2& uv) const {
        return uses_uv() ? glm::dvec3(uv, 0) : object;
    }
    /// The same by `place`.
    [[nodiscard]] glm::dvec3 colour_at(const glm::dvec3& place) const {
        return colour(place, glm::dvec2(place));
    }
    /// What `colour` may be between two places, at least: that of all cells or texels that a box around them
    /// meets. Half a picture apart they are on either side of a seam, and nothing lies between them.
    [[nodiscard]] ColourRange range(const glm::dvec3& low, const glm::dvec3& high) const;

  private:
    bool is_image_ = false;
    Checker checker_;
    ImageTexture image_;
    TexelRanges ranges_;
    double maximum_ = 0;
};

}  // namespace postlens
