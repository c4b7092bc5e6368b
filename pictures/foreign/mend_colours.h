// Replaces colours of another program's image that are not finite.
#pragma once

#include <cstddef>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Replaces colours that are not finite. In flat images they become the mean of finite neighbours, and in
/// deep images black. Only original colours enter the means, so the order of pixels does not matter. Returns
/// the number of replaced samples.
std::size_t mend_colours(ForeignPicture& picture);

}  // namespace postlens
