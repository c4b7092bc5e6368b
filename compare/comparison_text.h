// A comparison as text for people.
#pragma once

#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/drawing/side_by_side.h"

namespace postlens {

/// A table with a heading and one row each for the errors of the whole frame, of the affected pixels and of
/// the pinhole image.
[[nodiscard]] TextTable figures_table(const Comparison& comparison);

/// Returns sentences that complete the table: the error of the reference itself, and the exposures of FLIP.
[[nodiscard]] std::vector<std::string> comparison_notes(const Comparison& comparison);

/// Returns the table as text. Blanks align the first column to the left and the others to the right.
[[nodiscard]] std::string aligned(const TextTable& table);

}  // namespace postlens
