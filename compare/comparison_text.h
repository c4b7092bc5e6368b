// Formats the results of a comparison as text for people.
#pragma once

#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/drawing/side_by_side.h"

namespace postlens {

/// Returns a table of errors with a heading, first over the whole frame. With a pinhole image, further rows
/// contain errors over the pixels where the reference differs from it.
[[nodiscard]] TextTable figures_table(const Comparison& comparison);

/// Returns sentences to print below the table of errors. They state the noise of the reference and the
/// exposures that HDR-FLIP used.
[[nodiscard]] std::vector<std::string> comparison_notes(const Comparison& comparison);

/// Returns the table as text. The first column is left-aligned, and the others are right-aligned.
[[nodiscard]] std::string aligned(const TextTable& table);

}  // namespace postlens
