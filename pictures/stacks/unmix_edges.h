// Splits an edge pixel that shows several surfaces into one sample per surface.
#pragma once

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// Replaces every mixed pixel by a stack with one sample per surface, nearest first. A mixed pixel is one
/// that shows several surfaces (ForeignPicture::mixed). Compositing the stack gives the colour and alpha of
/// the original pixel. Farther surfaces continue behind nearer ones.
///
/// The depth and colour of a surface come from the nearest unmixed pixels of the same surface, within two
/// pixels (five if depths are means). The colours are then changed as little as possible so that their mean,
/// weighted by coverage, is the colour of the pixel.
///
/// A surface without unmixed pixels nearby gets the remaining colour. Its depth is that of the nearest mixed
/// pixels in which it covers more than any other surface. If there are no such pixels, the surface is
/// dropped, and the other surfaces fill the pixel. A surface that has an id but no depth is infinitely far.
///
/// Returns the number of split pixels. Afterwards, the image has no mixed pixels. Throws
/// Error(out_of_memory).
std::size_t unmix_edges(ForeignPicture& picture);

}  // namespace postlens
