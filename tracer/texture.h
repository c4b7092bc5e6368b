// Textures: colours over a surface, looked up in object space (checkers) or by (u, v) (images).
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace postlens {

/// A checker in object space, exact at cell borders: the cell of coordinate c is floor((c - offset) / size), borders
/// belong to the higher cell.
struct Checker {
    int dimensions = 3;  ///< 3: object-space x, y, z; 2: u, v
    glm::dvec3 size{1};  ///< cell edge; object-space metres, or (u, v)
    glm::dvec3 offset{0};
    glm::dvec3 even{1}, odd{0};
};

struct ImageTexture {
    int width = 0, height = 0;
    std::vector<float> rgb;  ///< scene-linear, top row first
    glm::dvec2 repeat{1};    ///< times over the unit square
    bool nearest = false;    ///< false: bilinear
};

class Texture {
  public:
    explicit Texture(Checker checker);
    explicit Texture(ImageTexture image);
    /// object: the hit in object space, m. uv: of the hit. A pure function.
    [[nodiscard]] glm::dvec3 colour(const glm::dvec3& object, const glm::dvec2& uv) const;

  private:
    bool is_image_ = false;
    Checker checker_;
    ImageTexture image_;
};

}  // namespace postlens
