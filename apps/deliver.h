// Writes the image that a command has made, or returns it to the caller.
#pragma once

#include <optional>
#include <string>

#include "apps/command.h"
#include "pictures/image.h"

namespace postlens {

/// Throws if an image cannot be written to a file of this name. Commands call this before they start to work.
void check_output(const std::string& output);

/// Where an image goes, and the metadata that its file states.
struct Delivery {
    std::string output;  ///< if empty, the image is returned in the result
    std::optional<Crop> crop;
    std::string made_by;  ///< Image::made_by
    std::optional<SharedWork> shared;
};

/// If `to` names an output file, writes the image of a command to it. Otherwise, adds the image to the
/// command's result `out`. Also adds the image's crop, exposure and warnings to `out` (report_picture).
void deliver(Image image, const Delivery& to, CommandResult& out);

/// Adds the crop and the exposure of the image `image` to the command's result `out`. If `output` is a PNG,
/// TIFF or JPEG file, warns if the image is too bright or too dark for it.
void report_picture(const Image& image, const std::string& output, const std::optional<Crop>& crop,
                    CommandResult& out);

}  // namespace postlens
