// Two images, the map of their differences and a table of errors, as one image.
#pragma once

#include <string>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// Texts in rows and columns; the first row is the heading.
using TextTable = std::vector<std::vector<std::string>>;

/// Size of the `side_by_side` of images of this size. `lines` counts the lines of text and the table's rows.
[[nodiscard]] ImageSize side_by_side_size(ImageSize pictures, std::size_t lines);

/// Shows image, reference and `error_map` from left to right, each below its name. The table and the lines
/// follow below; lines that are too long are clipped. Scene-linear, for `write_image`. The sizes must agree.
[[nodiscard]] Image side_by_side(const Image& image, const Image& reference, const TextTable& table,
                                 const std::vector<std::string>& lines);

}  // namespace postlens
