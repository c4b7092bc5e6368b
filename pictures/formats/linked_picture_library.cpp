// picture_library() for programs that link OpenImageIO.
#include "pictures/formats/oiio_picture_library.h"

namespace postlens {

const PictureLibrary& picture_library() {
    return oiio_picture_library();
}

}  // namespace postlens
