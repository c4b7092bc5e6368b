// Implementation of PictureLibrary by OpenImageIO.
#pragma once

#include "pictures/formats/picture_library.h"

namespace postlens {

[[nodiscard]] const PictureLibrary& oiio_picture_library();

}  // namespace postlens
