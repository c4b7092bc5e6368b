// Combines two images, their error map and a table into one image.
#pragma once

#include <string>
#include <vector>

#include "pictures/image.h"

namespace postlens {

/// A table of texts. The first row is the heading.
using TextTable = std::vector<std::vector<std::string>>;

/// Draws the image, the reference and their `error_map` side by side, above the table and the lines of text.
/// Long lines are clipped.
///
/// Both images must have the same size. Returns scene-linear values for `write_image`.
[[nodiscard]] Image side_by_side(const Image& image, const Image& reference, const TextTable& table,
                                 const std::vector<std::string>& lines);

}  // namespace postlens
