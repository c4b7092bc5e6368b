// Selects objects of the scene in an image from another program: by name, by id number, or by a mask image.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// An object, as the user names it in an option. It can be
/// - a name in the image's Cryptomatte,
/// - a number in the image's id channel, or
/// - a mask, which is an image file (.exr, .png, .tif, .tiff, .jpg or .jpeg) of the size of the raster.
///
/// The mean of the channels of a mask pixel, 0 to 1, is the fraction of the pixel that the object covers. The
/// object is at the depth of the pixel's nearest sample. Several masks cover different parts of a pixel,
/// unless their fractions add up to more than 1. Beyond the raster, the outermost values of a mask are
/// repeated.
struct ObjectChoice {
    std::string option;  ///< the option that names the object, for messages
    std::string object;
    [[nodiscard]] bool is_file() const;
};

/// Selects the samples of an object. Returns 1 for each sample of `picture` that belongs to the object, and 0
/// for the others. If a mask assigns only a part of a sample to the object, the sample is divided into two
/// samples of equal depth. Compositing these two gives the original colour and alpha. For a mask, `picture`
/// must not have mixed pixels (call `unmix_edges` first). Throws Error(wrong_arguments) with a list of the
/// existing names if no pixel shows the object. Throws Error(invalid_input) for a mask file that cannot be
/// read or has the wrong size.
[[nodiscard]] std::vector<std::uint8_t> choose_samples(ForeignPicture& picture, const ObjectChoice& choice);

/// Returns the fraction of each pixel of the image that the object selected by `choice` covers, row by row.
/// Throws the same errors as `choose_samples`.
[[nodiscard]] std::vector<float> choose_pixels(const ForeignPicture& picture, const ObjectChoice& choice);

}  // namespace postlens
