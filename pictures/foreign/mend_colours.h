// Replaces colours of another program's image that are not finite.
#pragma once

#include <cstddef>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Replaces colours that are not finite, and returns the number of replaced samples. In a flat image, the new
/// colour is the mean of the finite neighbours. It is black in a deep image, or if no neighbour is finite.
/// The means use only original colours, so the order of the pixels does not matter.
std::size_t mend_colours(ForeignPicture& picture);

}  // namespace postlens
