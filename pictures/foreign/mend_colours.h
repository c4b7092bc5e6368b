// Colours of another program's image that are not finite.
#pragma once

#include <cstddef>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Replaces colours that are not finite by the mean of the finite neighbours, in deep images by black. Uses
/// only original colours, so that the order does not matter. Returns the number of samples replaced.
std::size_t mend_colours(ForeignPicture& picture);

}  // namespace postlens
