// A comparison in words, for people.
#pragma once

#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/side_by_side.h"

namespace postlens {

/// The figures of the whole frame, of the affected pixels and of the pinhole picture, a row each below a
/// heading.
[[nodiscard]] TextTable figures_table(const Comparison& comparison);

/// What a table cannot say, a sentence each: what FLIP looked at, what the reference is good for.
[[nodiscard]] std::vector<std::string> comparison_notes(const Comparison& comparison);

/// Columns aligned with blanks; the first to the left, the others to the right.
[[nodiscard]] std::string aligned(const TextTable& table);

}  // namespace postlens
