// Splits edge pixels that show several surfaces into one sample per surface, by the coverages of a
// Cryptomatte.
#pragma once

#include "records/foreign_picture.h"

namespace postlens {

/// Replaces every mixed pixel (ForeignPicture::mixed) by a stack with one sample per surface, nearest first,
/// which composites to the same colour and alpha; farther surfaces continue behind nearer ones.
///
/// Depth and colour of a surface come from the nearest unmixed pixels of the same surface within two pixels.
/// The colours are then changed by the smallest amount that makes their sum equal the pixel's colour, without
/// becoming negative where the pixel is not. If a surface has no unmixed pixel nearby, it gets the remaining
/// colour and the depth of the nearest pixels in which it has the largest share; if there is none either, its
/// share goes to the other surfaces. A surface with an id but without depth is infinitely far.
///
/// Returns the number of pixels split; afterwards the image has no mixed pixels. Throws Error(out_of_memory).
std::size_t unmix_edges(ForeignPicture& picture);

}  // namespace postlens
