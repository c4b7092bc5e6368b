// What a program and the module with OpenImageIO agree on.
#pragma once

#include "records/picture_library.h"

/// Its name is another where PictureLibrary is: a module of another version is not taken for this one.
extern "C" const postlens::PictureLibrary* postlens_picture_library_1();

namespace postlens {

inline constexpr const char* picture_module_symbol = "postlens_picture_library_1";

}  // namespace postlens
