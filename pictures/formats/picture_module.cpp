// Entry point of the module that loaded_picture_library.cpp loads.
#include "pictures/formats/picture_module.h"

#include "pictures/formats/oiio_picture_library.h"

extern "C" __attribute__((visibility("default"))) const postlens::PictureLibrary*
postlens_picture_library_1() {
    return &postlens::oiio_picture_library();
}
