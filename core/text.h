// Reads numbers from text independently of the locale, and prepares text for messages.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace postlens {

/// Converts the whole `text`, a decimal number such as "1", "-.5", "+2e-3", "inf" or "nan". Returns infinity
/// if it is too large, and nothing if it is not a number.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// Returns at most 40 characters of text from a file, in single quotes, with unprintable characters replaced.
[[nodiscard]] std::string excerpt(std::string_view text);

/// Converts the letters A to Z to lower case.
[[nodiscard]] std::string lower_case(std::string text);

/// Returns the error message of a library as one line, or "no reason given" if it is empty.
[[nodiscard]] std::string reason_of(std::string message);

/// Returns a message as one line. Control characters become question marks, because a terminal may obey them.
[[nodiscard]] std::string printable(std::string text);
/// Like printable, but keeps line ends.
[[nodiscard]] std::string printable_lines(std::string text);

/// Formats a number without an exponent, with two significant digits or as an integer: 0.12, 3.4, 56 or 789.
[[nodiscard]] std::string rough(double value);

/// Returns the first candidate with the smallest edit distance to `word`, or an empty text if all need more
/// than `most_edits`. A swap of neighbouring letters is one edit.
[[nodiscard]] std::string_view nearest_word(std::string_view word,
                                            std::span<const std::string_view> candidates,
                                            std::size_t most_edits = std::numeric_limits<std::size_t>::max());

}  // namespace postlens
