#pragma once

#include <glm/vec2.hpp>

namespace postlens {

/// Rotates the point p about the origin. The rotation is the one that turns +y into the unit vector `axis`.
/// This is valid whether y points down (raster) or up (camera), because lenses are symmetric about their
/// axis.
inline glm::dvec2 turned(const glm::dvec2& p, const glm::dvec2& axis) {
    return {p.x * axis.y + p.y * axis.x, -p.x * axis.x + p.y * axis.y};
}

}  // namespace postlens
