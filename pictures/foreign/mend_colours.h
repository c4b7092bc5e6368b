// Replaces colours of another program's image that are not finite.
#pragma once

#include <cmath>
#include <cstddef>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

[[nodiscard]] inline bool has_finite_colour(const StackSample& s) {
    return std::isfinite(s.r) && std::isfinite(s.g) && std::isfinite(s.b);
}

/// Numbers of samples whose colours mend_colours has replaced.
struct MendedColours {
    std::size_t by_mean = 0;   ///< by the mean of finite neighbours
    std::size_t by_black = 0;  ///< by black
};

/// Replaces colours that are not finite. In a flat image, they become the mean of the finite original
/// neighbours. In a deep image, or without such neighbours, they become black.
MendedColours mend_colours(ForeignPicture& picture);

}  // namespace postlens
