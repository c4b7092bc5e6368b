// Writes or returns the image that a command has made.
#pragma once

#include <optional>
#include <string>

#include "apps/command.h"
#include "pictures/image.h"

namespace postlens {

/// Refuses an output file that write_image cannot write. Commands call this before their work.
void check_output(const std::string& output);

/// Where an image goes, and what its file says of it.
struct Delivery {
    std::string output;  ///< empty: into the result
    std::optional<Crop> crop;
    std::string made_by;  ///< Image::made_by
    std::optional<SharedWork> shared;
};

/// Writes the image, or returns it in the result. Also calls report_picture.
void deliver(Image image, const Delivery& to, CommandResult& out);

/// Adds crop and exposure to the result, and warns if the image is too bright or too dark for a
/// PNG, TIFF or JPEG.
void report_picture(const Image& image, const std::string& output, const std::optional<Crop>& crop,
                    CommandResult& out);

}  // namespace postlens
