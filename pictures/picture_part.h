// Parts of an image that are computed separately. The joined image is bit-identical to an image computed as a
// whole.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pictures/image.h"

namespace postlens {

/// Marks an image so that `write_image` writes a crop of it as a part. The file then stores the exact values,
/// without dividing them by the exposure; the mark contains the exposure instead. `mark` is a JSON object of
/// the caller's choice.
void mark_as_part(Image& image, const std::optional<Crop>& crop, const std::string& mark);

struct PicturePart {
    Image image;       ///< the pixels of the part; with alpha only if the file stores it as floats
    Crop place;        ///< position of these pixels in the whole image
    ImageSize whole;   ///< size of the whole image, px
    std::string mark;  ///< the caller's JSON object, as given to `mark_as_part`
};

/// Reads a part of an image. Empty if the file has no mark or is not OpenEXR. Throws Error(invalid_input)
/// if the file cannot be read, or if its pixels were changed after it was written.
[[nodiscard]] std::optional<PicturePart> read_picture_part(const std::filesystem::path& path);

/// Attribute in which a part of a render's samples (tracer/distributed/render_state.h) has its mark.
inline constexpr const char* samples_part_attribute = "postlens:part";

/// Reads the mark of a part of an image or of a render's samples. Empty for any other OpenEXR file. Throws
/// Error(invalid_input).
[[nodiscard]] std::string read_part_mark(const std::filesystem::path& path);

/// Copies the pixels of a part to their position in `whole`. Throws Error(invalid_input), which names the
/// file `name`, if the part and `whole` have different channels.
void paste(const PicturePart& part, const std::string& name, Image& whole);

}  // namespace postlens
