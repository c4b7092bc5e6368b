// Determines which surfaces the pixels of a flat image show, from its Cryptomatte.
#pragma once

#include "pictures/foreign/cryptomatte.h"
#include "pictures/foreign/foreign_file.h"
#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Gives each sample of `picture` the Cryptomatte id that covers most of its pixel. Adds pixels that show
/// several surfaces to ForeignPicture::mixed. `onto` is the part of the file from which the colours of
/// `picture` were read. Throws Error(invalid_input) and Error(out_of_memory).
void take_matte(const ForeignFile& file, const ForeignPart& onto, const Cryptomatte& matte,
                ForeignPicture& picture);

}  // namespace postlens
