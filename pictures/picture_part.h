// Parts of an image that are computed separately. An image joined from parts is bit-identical to an image
// that is computed as a whole.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pictures/image.h"

namespace postlens {

/// Marks an image so that `write_image` writes a crop of it as a part. The file then stores the exact values,
/// without dividing them by the exposure. The exposure is stored in the mark instead. `mark` is a JSON object
/// that the caller chooses.
void mark_as_part(Image& image, const std::optional<Crop>& crop, const std::string& mark);

struct PicturePart {
    Image image;       ///< the pixels of the part; with alpha only if the file stores it as floats
    Crop place;        ///< position of the part in the whole image
    ImageSize whole;   ///< size of the whole image, px
    std::string mark;  ///< the caller's JSON object, as given to `mark_as_part`
};

/// Reads a part of an image. Returns empty if the file has no mark or is not an OpenEXR file. Throws
/// Error(invalid_input) if the file cannot be read, or if its pixels were changed after it was written.
[[nodiscard]] std::optional<PicturePart> read_picture_part(const std::filesystem::path& path);

/// Attribute that holds the mark of a part of a render's samples (tracer/distributed/render_state.h).
inline constexpr const char* samples_part_attribute = "postlens:part";

/// Reads the mark of a part of an image, or of a part of a render's samples. Returns empty for any other
/// OpenEXR file. Throws Error(invalid_input).
[[nodiscard]] std::string read_part_mark(const std::filesystem::path& path);

/// Copies the pixels of a part to their position in `whole`. Throws Error(invalid_input) if `part` and
/// `whole` have different channels. The message calls the file of the part `name`.
void paste(const PicturePart& part, const std::string& name, Image& whole);

}  // namespace postlens
