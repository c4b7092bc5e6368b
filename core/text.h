// Text of input files: numbers that do not depend on the locale, and excerpts that are safe to print.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace postlens {

/// Converts all of `text`, a decimal number such as "1", "-.5" or "+2e-3". Accepts "inf" and "nan"; returns
/// infinity on overflow. Empty if the text is not a number.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// Up to 40 characters of text from a file, in single quotes, with unprintable characters replaced.
[[nodiscard]] std::string excerpt(std::string_view text);

/// Converts the letters A to Z to lower case.
[[nodiscard]] std::string lower_case(std::string text);

/// Returns a library's error message, which may have several lines, as one line. Returns "no reason given"
/// for an empty message.
[[nodiscard]] std::string reason_of(std::string message);

/// Returns a message as one line: control characters, which may come from files and options, become question
/// marks.
[[nodiscard]] std::string printable(std::string text);

/// Formats a number with two significant digits and without exponent: 0.12, 3.4, 56, 789. Numbers below 0.001
/// are rounded to three decimals.
[[nodiscard]] std::string rough(double value);

/// Returns the candidate with the smallest edit distance to `word` (insertions, deletions, replacements and
/// swaps of neighbouring letters). If several have the same distance, returns the first. Empty if there are
/// no candidates.
[[nodiscard]] std::string_view nearest_word(std::string_view word,
                                            std::span<const std::string_view> candidates);

}  // namespace postlens
