// Writes or returns the image that a command has made.
#pragma once

#include <optional>
#include <string>

#include "apps/command.h"
#include "pictures/image.h"

namespace postlens {

/// Throws an error if write_image cannot write a file of this name. Commands call it before their work.
void check_output(const std::string& output);

/// The destination of an image, and the metadata that its file states.
struct Delivery {
    std::string output;  ///< empty: into the result
    std::optional<Crop> crop;
    std::string made_by;  ///< Image::made_by
    std::optional<SharedWork> shared;
};

/// Writes the image to its file, or returns it in the result if there is none. Also calls report_picture.
void deliver(Image image, const Delivery& to, CommandResult& out);

/// Adds crop and exposure to the result. Warns if the image is too bright or too dark for a PNG, TIFF or
/// JPEG.
void report_picture(const Image& image, const std::string& output, const std::optional<Crop>& crop,
                    CommandResult& out);

}  // namespace postlens
