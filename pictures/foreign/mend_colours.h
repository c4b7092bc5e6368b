// Repairs colours of another program's image that are not finite.
#pragma once

#include <cstddef>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Replaces colours that are not finite: in flat images by the mean of finite neighbours, in deep images by
/// black. Means use only original colours, so the order of pixels does not matter. Returns the number of
/// replaced samples.
std::size_t mend_colours(ForeignPicture& picture);

}  // namespace postlens
