// Replaces colours of another program's image that are not finite.
#pragma once

#include <cstddef>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Numbers of samples whose colours mend_colours has replaced.
struct MendedColours {
    std::size_t by_mean = 0;   ///< by the mean of finite neighbours
    std::size_t by_black = 0;  ///< by black
};

/// Replaces colours that are not finite. In a flat image, the new colour is the mean of the finite
/// neighbours. It is black in a deep image, or if no neighbour is finite. The means use only original
/// colours, so the order of the pixels does not matter.
MendedColours mend_colours(ForeignPicture& picture);

}  // namespace postlens
