// Text in input files: numbers without regard to the locale, and excerpts that are safe to show.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace postlens {

/// The whole of `text` as a decimal number ("1", "-.5", "+2e-3"); infinite or NaN where it says so or
/// overflows. Empty where it is not a number.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// At most 40 characters of text from a file, unprintable ones replaced, in single quotes.
[[nodiscard]] std::string excerpt(std::string_view text);

/// A number in two digits and without an exponent: 0.12, 3.4, 56, 789; 0.001 is the least that is shown.
[[nodiscard]] std::string rough(double value);

/// The candidate with the fewest insertions, deletions, replacements and swaps of neighbours to `word`; the
/// first of equals. Empty where there are no candidates.
[[nodiscard]] std::string_view nearest_word(std::string_view word,
                                            std::span<const std::string_view> candidates);

}  // namespace postlens
