// Interface between a program and the module that contains OpenImageIO.
#pragma once

#include "pictures/formats/picture_library.h"

/// Returns the image library of a module that a program loads at run time. The number at the end of the
/// function's name is increased whenever PictureLibrary changes. So a program cannot find this function in a
/// module of another version, and does not use that module by mistake.
extern "C" const postlens::PictureLibrary* postlens_picture_library_1();

namespace postlens {

inline constexpr const char* picture_module_symbol = "postlens_picture_library_1";

}  // namespace postlens
