// Combines two images, the map of their differences and a table of errors in one image.
#pragma once

#include <string>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// Texts in rows and columns; the first row is the heading.
using TextTable = std::vector<std::vector<std::string>>;

/// Shows image, reference and `error_map` from left to right, each below its name. The table and the lines
/// follow below. Lines that are too long are clipped. The result is scene-linear, for `write_image`. Image
/// and reference must have the same size.
[[nodiscard]] Image side_by_side(const Image& image, const Image& reference, const TextTable& table,
                                 const std::vector<std::string>& lines);

}  // namespace postlens
