// Combines two images, the map of their differences, and a table of errors into one image.
#pragma once

#include <string>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// A table of texts. The first row is the heading.
using TextTable = std::vector<std::vector<std::string>>;

/// Draws the image, the reference and their `error_map` from left to right, each below its name. The table
/// and the lines of text follow below. Lines that are too long are clipped. Returns scene-linear values for
/// `write_image`. The image and the reference must have the same size.
[[nodiscard]] Image side_by_side(const Image& image, const Image& reference, const TextTable& table,
                                 const std::vector<std::string>& lines);

}  // namespace postlens
