// Parts of an image that are made apart from each other, and joined to the bits of the undivided image.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "records/image.h"

namespace postlens {

/// Marks an image of which `write_image` is to write a crop as a part. The exact values are then stored: they
/// are not divided by the exposure, which the mark keeps. `mark` is a JSON object of the caller's.
void mark_as_part(Image& image, const std::optional<Crop>& crop, const std::string& mark);

struct PicturePart {
    Image image;       ///< the pixels of the part; with alpha only if the file stores it as floats
    Crop place;        ///< where they lie in the whole
    ImageSize whole;   ///< of the whole, px
    std::string mark;  ///< as `mark_as_part` got it
};

/// Reads a part. Empty if the file is an OpenEXR file without a mark. Throws Error(invalid_input) for a file
/// that cannot be read, that is no OpenEXR file, or whose pixels have been changed since.
[[nodiscard]] std::optional<PicturePart> read_picture_part(const std::filesystem::path& path);

/// Copies the pixels of a part, of the same channels, to their place in `whole`. Throws Error(invalid_input)
/// for other channels.
void paste(const PicturePart& part, const std::string& name, Image& whole);

}  // namespace postlens
