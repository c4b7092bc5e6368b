// Formats the results of a comparison as text for people.
#pragma once

#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/drawing/side_by_side.h"

namespace postlens {

/// Returns a table with the errors of the tested image, below a heading. The first rows contain the errors
/// over the whole frame. If the comparison has a pinhole image, further rows contain the errors over only
/// those pixels in which the reference differs from it, i.e. which are blurred.
[[nodiscard]] TextTable figures_table(const Comparison& comparison);

/// Returns sentences to print below the table of errors. They state the noise of the reference and the
/// exposures that HDR-FLIP used.
[[nodiscard]] std::vector<std::string> comparison_notes(const Comparison& comparison);

/// Returns the table as text. The first column is left-aligned, and the others are right-aligned.
[[nodiscard]] std::string aligned(const TextTable& table);

}  // namespace postlens
