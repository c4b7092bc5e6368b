// Determines which surfaces the pixels of a flat image show, from its Cryptomatte.
#pragma once

#include "pictures/foreign/cryptomatte.h"
#include "pictures/foreign/foreign_file.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Sets the id of each sample to the id with the largest share of the pixel. Adds pixels that show several
/// surfaces to ForeignPicture::mixed. `onto` is the part with the colours, whose samples are in `picture`.
/// Throws Error(invalid_input) and Error(out_of_memory).
void take_matte(const ForeignFile& file, const ForeignPart& onto, const Cryptomatte& matte,
                ForeignPicture& picture);

}  // namespace postlens
