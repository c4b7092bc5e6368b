// Parts of an image that are made separately, and joined to an image with the same bits as the undivided one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pictures/image.h"

namespace postlens {

/// Marks an image so that `write_image` writes a crop of it as a part. The file then holds the exact values,
/// which are not divided by the exposure; the mark holds the exposure. `mark` is a JSON object of the
/// caller's.
void mark_as_part(Image& image, const std::optional<Crop>& crop, const std::string& mark);

struct PicturePart {
    Image image;       ///< the pixels of the part; with alpha only if the file stores it as floats
    Crop place;        ///< position of these pixels in the whole image
    ImageSize whole;   ///< size of the whole image, px
    std::string mark;  ///< as `mark_as_part` got it
};

/// Reads a part. Empty if the file is an OpenEXR file without a mark. Throws Error(invalid_input) for a file
/// that cannot be read, that is no OpenEXR file, or whose pixels have been changed after it was written.
[[nodiscard]] std::optional<PicturePart> read_picture_part(const std::filesystem::path& path);

/// Copies the pixels of a part to their position in `whole`. Throws Error(invalid_input) if the part and
/// `whole` have different channels.
void paste(const PicturePart& part, const std::string& name, Image& whole);

}  // namespace postlens
