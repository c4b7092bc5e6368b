// Edge pixels that several surfaces share, taken apart by what a Cryptomatte says of them.
#pragma once

#include "records/foreign_picture.h"

namespace postlens {

/// Makes of every mixed pixel (ForeignPicture::mixed) a stack with a sample for each surface, nearest first,
/// that flattens to the same colour and alpha: side by side as shares say, so that what is farther goes on
/// behind what is nearer. A surface has the depth and colour of its nearest pixels that are not mixed, two
/// pixels around; colours are then changed as little as makes their sum the pixel's, and are not negative
/// where the pixel's is not. Of a surface that has no such pixels the colour is what the others leave, and
/// the depth that of the nearest pixels of which it has the most; without any its share goes to the others.
/// What has an id but no depth is infinitely far. Returns how many pixels were taken apart; the picture has
/// no mixed pixels then. Throws Error(out_of_memory).
std::size_t unmix_edges(ForeignPicture& picture);

}  // namespace postlens
