// Formats the results of a comparison as text for people.
#pragma once

#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/drawing/side_by_side.h"

namespace postlens {

/// Returns a table of errors with a heading. The first row is for the whole frame. If a pinhole image is
/// given, further rows contain the errors over the affected pixels, and those of the pinhole image.
[[nodiscard]] TextTable figures_table(const Comparison& comparison);

/// Returns sentences to print below the table. They state the error of the reference and the exposures of
/// FLIP.
[[nodiscard]] std::vector<std::string> comparison_notes(const Comparison& comparison);

/// Returns the table as text. The first column is left-aligned and the others are right-aligned.
[[nodiscard]] std::string aligned(const TextTable& table);

}  // namespace postlens
