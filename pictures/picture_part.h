// Parts of an image that are computed separately, for example on several machines. Joined, they equal an
// undivided image bit by bit.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pictures/image.h"

namespace postlens {

/// Prepares an image, so that write_image(), called with the same `crop`, writes a part of it that can later
/// be joined with other parts: the rectangle `crop`, or the whole image. The file then contains the exact
/// values, the exposure, and `mark`, a JSON object by which the caller recognises the part.
void mark_as_part(Image& image, const std::optional<Crop>& crop, const std::string& mark);

struct PicturePart {
    Image image;       ///< the pixels of the part; with alpha only if the file stores it as floats
    Crop place;        ///< position of the part in the whole image
    ImageSize whole;   ///< size of the whole image, px
    std::string mark;  ///< the caller's JSON object, as given to `mark_as_part`
};

/// Reads a file with one part (crop) of an image, which was written to be joined with other parts. Returns
/// empty if mark_as_part() did not mark this file. Throws Error(invalid_input) if the file cannot be read, or
/// its pixels were changed.
[[nodiscard]] std::optional<PicturePart> read_picture_part(const std::filesystem::path& path);

/// Attribute that marks an OpenEXR file as one part of a render: it contains some of the samples of every
/// pixel (tracer/distributed/render_state.h).
inline constexpr const char* samples_part_attribute = "postlens:part";

/// Reads the JSON object that marks the file `path` as a part of an image (some of its pixels) or of a render
/// (some of the samples of every pixel). Returns an empty text for any other OpenEXR file. Throws
/// Error(invalid_input).
[[nodiscard]] std::string read_part_mark(const std::filesystem::path& path);

/// Copies the pixels of `part`, a rectangle of a larger image that was computed separately, to their position
/// in the larger image, `whole`. Throws Error(invalid_input), with the file name `name`, if the channels
/// differ.
void paste(const PicturePart& part, const std::string& name, Image& whole);

}  // namespace postlens
