// Selects objects in another program's image: by name, by id number, or by a mask image.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// An object, as options name it:
/// - a name in the image's Cryptomatte,
/// - a number in the image's id channel, or
/// - a mask: an image file of the size of the raster, whose name ends in .exr, .png, .tif, .tiff, .jpg or
///   .jpeg. The mean of a mask pixel's channels, 0 to 1, is the share of the pixel that the object covers.
///   The object is at the depth of the nearest sample of the pixel's stack. Masks of several files cover
///   different parts of a pixel, unless their shares add up to more than 1. Beyond the raster, the outermost
///   values of a mask continue.
struct ObjectChoice {
    std::string option;  ///< the option that names the object, for messages
    std::string object;
    [[nodiscard]] bool is_file() const;
};

/// Selects the samples of an object. Returns 1 for each sample of `picture` that belongs to the object, and 0
/// for the others. If a mask assigns only a part of a sample to the object, the sample is divided into two
/// samples of equal depth; together they composite to the same colour and alpha. `picture` must not have
/// mixed pixels then (call `unmix_edges` first). Throws Error(wrong_arguments), which lists the existing
/// names, if no pixel shows the object. Throws Error(invalid_input) for a mask file that cannot be read or
/// has another size.
[[nodiscard]] std::vector<std::uint8_t> choose_samples(ForeignPicture& picture, const ObjectChoice& choice);

/// Returns the share of each pixel that shows the object, for all pixels of the raster, row by row. Throws as
/// `choose_samples` does.
[[nodiscard]] std::vector<float> choose_pixels(const ForeignPicture& picture, const ObjectChoice& choice);

}  // namespace postlens
