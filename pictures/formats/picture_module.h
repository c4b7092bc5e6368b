// Interface between a program and the module that contains OpenImageIO.
#pragma once

#include "pictures/formats/picture_library.h"

/// The number in the name changes with every change of PictureLibrary, so that a program cannot use a module
/// of another version.
extern "C" const postlens::PictureLibrary* postlens_picture_library_1();

namespace postlens {

inline constexpr const char* picture_module_symbol = "postlens_picture_library_1";

}  // namespace postlens
