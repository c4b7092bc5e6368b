// Text in input files: numbers independent of the locale, and excerpts that are safe to print.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace postlens {

/// Converts all of `text`, a decimal number such as "1", "-.5" or "+2e-3". The result is infinite or NaN if
/// the text says so, and infinite on overflow. Empty if the text is not a number.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// At most 40 characters of text from a file, unprintable ones replaced, in single quotes.
[[nodiscard]] std::string excerpt(std::string_view text);

/// A number with two significant digits and without exponent: 0.12, 3.4, 56, 789. Numbers below 0.001 are
/// rounded to three decimals.
[[nodiscard]] std::string rough(double value);

/// The candidate with the smallest edit distance to `word` (insertions, deletions, replacements and swaps of
/// neighbouring letters); the first of several. Empty if there are no candidates.
[[nodiscard]] std::string_view nearest_word(std::string_view word,
                                            std::span<const std::string_view> candidates);

}  // namespace postlens
