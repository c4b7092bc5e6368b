// Parts of an image that are computed separately, for example on several machines. The joined image is
// bit-identical to an image that is computed as a whole.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pictures/image.h"

namespace postlens {

/// Prepares an image so that `write_image`, with the same `crop`, writes it as a part that can later be
/// joined with others. The file then contains exactly the image's values, including its exposure. `mark` is a
/// JSON object of the caller. It is stored in the header, together with the exposure.
void mark_as_part(Image& image, const std::optional<Crop>& crop, const std::string& mark);

struct PicturePart {
    Image image;       ///< the pixels of the part; with alpha only if the file stores it as floats
    Crop place;        ///< position of the part in the whole image
    ImageSize whole;   ///< size of the whole image, px
    std::string mark;  ///< the caller's JSON object, as given to `mark_as_part`
};

/// Reads a part of an image. Returns empty if the file was not marked by mark_as_part. Throws
/// Error(invalid_input) if the file cannot be read, or if its pixels were changed after it was written.
[[nodiscard]] std::optional<PicturePart> read_picture_part(const std::filesystem::path& path);

/// Header attribute of a file that contains some of the samples of every pixel of a render
/// (tracer/distributed/render_state.h).
inline constexpr const char* samples_part_attribute = "postlens:part";

/// Reads the JSON mark of a part of an image, or of a part of the samples of a render. Returns an empty text
/// for any other OpenEXR file. Throws Error(invalid_input).
[[nodiscard]] std::string read_part_mark(const std::filesystem::path& path);

/// Copies the pixels of a part to their position in the image `whole`. Throws Error(invalid_input) if the
/// channels of the part and of the image differ. `name` is the file name in the error message.
void paste(const PicturePart& part, const std::string& name, Image& whole);

}  // namespace postlens
