// Which surfaces the pixels of a flat image show, by its Cryptomatte.
#pragma once

#include "pictures/foreign/cryptomatte.h"
#include "pictures/foreign/foreign_file.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Sets the id of each sample to that with the largest share of its pixel, and adds the pixels with several
/// surfaces to ForeignPicture::mixed. `onto`: the part with the colours, whose samples are in `picture`.
/// Throws Error(invalid_input) and Error(out_of_memory).
void take_matte(const ForeignFile& file, const ForeignPart& onto, const Cryptomatte& matte,
                ForeignPicture& picture);

}  // namespace postlens
