// Splits edge pixels that show several surfaces into one sample per surface, by the surfaces' shares of the
// pixel.
#pragma once

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Replaces every mixed pixel (ForeignPicture::mixed) by a stack with one sample per surface, nearest first.
/// The stack composites to the same colour and alpha. Farther surfaces continue behind nearer ones.
///
/// Depth and colour of a surface come from the nearest unmixed pixels of the same surface within two pixels.
/// The colours are then changed by the smallest amount that makes their sum equal the pixel's colour, without
/// becoming negative where the pixel is not. A surface without an unmixed pixel nearby gets the remaining
/// colour, and the depth of the nearest pixels in which it has the largest share. If there are no such pixels
/// either, its share goes to the other surfaces. A surface with an id but without depth is infinitely far.
///
/// Returns the number of pixels split; afterwards the image has no mixed pixels. Throws Error(out_of_memory).
std::size_t unmix_edges(ForeignPicture& picture);

}  // namespace postlens
