// Two pictures, the map of their differences and what was measured, as one picture.
#pragma once

#include <string>
#include <vector>

#include "records/image.h"

namespace postlens {

/// Texts in rows and columns; the first row is the heading.
using TextTable = std::vector<std::vector<std::string>>;

/// Size of `side_by_side` for pictures of this size and so many lines of text, the rows of the table
/// included.
[[nodiscard]] ImageSize side_by_side_size(ImageSize pictures, std::size_t lines);

/// From left to right image, reference and `error_map`, each under its name; below them the table and the
/// lines, which are cut off where they are too long. Scene-linear, to be written with `write_image`. Sizes
/// must agree.
[[nodiscard]] Image side_by_side(const Image& image, const Image& reference, const TextTable& table,
                                 const std::vector<std::string>& lines);

}  // namespace postlens
