// Splits an edge pixel that shows several surfaces into one sample per surface.
#pragma once

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Replaces every mixed pixel, which shows several surfaces (ForeignPicture::mixed), by a stack with one
/// sample per surface, nearest first. The stack composites to the colour and alpha of the pixel. Farther
/// surfaces continue behind nearer ones.
///
/// The depth and colour of a surface come from the nearest unmixed pixels of the same surface, within two
/// pixels (five if depths are means). The colours are then changed by the smallest amount that makes their
/// sum equal to the pixel's colour. They become negative only where the pixel is negative.
///
/// A surface without unmixed pixels nearby gets the remaining colour. Its depth is that of the nearest pixels
/// of which it covers the largest fraction. If there are no such pixels, its fraction is given to the other
/// surfaces. A surface that has an id but no depth is infinitely far.
///
/// Returns the number of split pixels. Afterwards, the image has no mixed pixels. Throws
/// Error(out_of_memory).
std::size_t unmix_edges(ForeignPicture& picture);

}  // namespace postlens
