// Interface between a program and the module that contains OpenImageIO.
#pragma once

#include "pictures/formats/picture_library.h"

/// Returns the functions of a loaded module that read and write image files (PictureLibrary). The number at
/// the end of this function's name is increased whenever PictureLibrary changes, so that a program cannot use
/// a module of another version by mistake.
extern "C" const postlens::PictureLibrary* postlens_picture_library_1();

namespace postlens {

inline constexpr const char* picture_module_symbol = "postlens_picture_library_1";

}  // namespace postlens
