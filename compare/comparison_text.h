// A comparison as text for people.
#pragma once

#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/drawing/side_by_side.h"

namespace postlens {

/// Errors of the whole frame, of the affected pixels and of the pinhole image: one row each, below a heading.
[[nodiscard]] TextTable figures_table(const Comparison& comparison);

/// Sentences that complete the table: the error of the reference itself, and the exposures of FLIP.
[[nodiscard]] std::vector<std::string> comparison_notes(const Comparison& comparison);

/// The table as text. Blanks align its columns: the first to the left, the others to the right.
[[nodiscard]] std::string aligned(const TextTable& table);

}  // namespace postlens
