// Reads numbers from text independently of the locale, and prepares text for messages.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace postlens {

/// Converts the whole `text`, a decimal number such as "1", "-.5" or "+2e-3". Also accepts "inf" and "nan".
/// Returns infinity if the number is too large, and an empty value if the text is not a number.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// Returns at most 40 characters of text from a file, in single quotes. Unprintable characters are replaced.
[[nodiscard]] std::string excerpt(std::string_view text);

/// Converts the letters A to Z to lower case.
[[nodiscard]] std::string lower_case(std::string text);

/// Returns the error message of a library as one line, even if it has several lines. Returns "no reason
/// given" for an empty message.
[[nodiscard]] std::string reason_of(std::string message);

/// Returns a message as one line. Control characters, which can come from files and options, become question
/// marks, because a terminal may obey them.
[[nodiscard]] std::string printable(std::string text);
/// Does the same for a text of several lines, whose line ends are kept.
[[nodiscard]] std::string printable_lines(std::string text);

/// Formats a number with two significant digits and without an exponent: 0.12, 3.4, 56, 789. Numbers below
/// 0.001 are rounded to three decimals.
[[nodiscard]] std::string rough(double value);

/// Returns the candidate with the smallest edit distance to `word`. Edits are insertions, deletions,
/// replacements and swaps of neighbouring letters. If several candidates are equally close, the first one is
/// returned. The result is empty if all candidates need more than `most_edits`, or if there are none.
[[nodiscard]] std::string_view nearest_word(std::string_view word,
                                            std::span<const std::string_view> candidates,
                                            std::size_t most_edits = std::numeric_limits<std::size_t>::max());

}  // namespace postlens
