// Selects objects in an image of another program by name, by id number, or by a mask image.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pictures/foreign/foreign_picture.h"

namespace postlens {

/// An object as options name it:
/// - a name of the image's Cryptomatte,
/// - a number of its id channel, or
/// - a mask: an image file (its name ends in .exr, .png, .tif, .tiff, .jpg or .jpeg) of the size of the
/// raster. The mean of its channels, 0 to 1, is the share of each pixel that belongs to the object. It
/// applies to the nearest sample of a pixel's stack.
struct ObjectChoice {
    std::string option;  ///< the option that names it, for messages
    std::string object;
    [[nodiscard]] bool is_file() const;
};

/// Selects the samples of an object: 1 for each sample of `picture` that belongs to it, else 0. A sample that
/// belongs to the object only in part, by a mask, is divided into two samples of the same depth that
/// composite to the same colour and alpha. `picture` must then have no mixed pixels (`unmix_edges` first).
/// Throws Error(wrong_arguments), which lists the existing names, if no pixel shows the object. Throws
/// Error(invalid_input) for a file that cannot be read or has another size.
[[nodiscard]] std::vector<std::uint8_t> choose_samples(ForeignPicture& picture, const ObjectChoice& choice);

/// The share of each pixel of the raster that shows the object, row by row. Throws as `choose_samples`.
[[nodiscard]] std::vector<float> choose_pixels(const ForeignPicture& picture, const ObjectChoice& choice);

}  // namespace postlens
