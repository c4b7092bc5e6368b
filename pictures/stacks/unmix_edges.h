// Splits edge pixels that show several surfaces into one sample per surface, using each surface's share of
// the pixel.
#pragma once

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Replaces every mixed pixel (ForeignPicture::mixed) by a stack with one sample per surface, nearest first.
/// The stack composites to the same colour and alpha as the pixel. Farther surfaces continue behind nearer
/// ones.
///
/// A surface's depth and colour come from the nearest unmixed pixels of the same surface, within two pixels
/// (five if depths are means). Colours are then changed by the smallest amount that makes their sum equal the
/// pixel's colour; they become negative only where the pixel is. A surface without unmixed pixels nearby gets
/// the remaining colour, and the depth of the nearest pixels in which it has the largest share. Without such
/// pixels, its share is given to the other surfaces. A surface that has an id but no depth is infinitely far.
///
/// Returns the number of split pixels. Afterwards, the image has no mixed pixels. Throws
/// Error(out_of_memory).
std::size_t unmix_edges(ForeignPicture& picture);

}  // namespace postlens
