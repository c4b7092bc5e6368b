// Interface between a program and the module that contains OpenImageIO.
#pragma once

#include "pictures/formats/picture_library.h"

/// The number in the name changes when PictureLibrary changes, so a module of another version is not
/// accepted.
extern "C" const postlens::PictureLibrary* postlens_picture_library_1();

namespace postlens {

inline constexpr const char* picture_module_symbol = "postlens_picture_library_1";

}  // namespace postlens
