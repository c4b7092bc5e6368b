// Splits CODE V sequence files into commands, words and numbers.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace postlens {

using SeqWords = std::vector<std::string_view>;

/// Splits the text of a CODE V file into commands. Each is returned with the number of its last line in the
/// file. Comments are removed, and commands that continue on several lines are joined.
///
/// Throws Error(invalid_input) if a command has more than 100000 characters.
[[nodiscard]] std::vector<std::pair<int, std::string>> seq_commands(const std::string& text,
                                                                    const std::string& file);

/// Converts a word to upper case.
[[nodiscard]] std::string upper_case(std::string_view word);

/// Returns word number `i` of a command as a number. `file`, `line` and `what`, the name of the number, are
/// used in error messages. Throws Error(invalid_input) if the word is missing or not a finite number.
[[nodiscard]] double seq_number(const std::string& file, int line, const SeqWords& words, std::size_t i,
                                std::string_view what);

/// Throws Error(invalid_input) for a command of a CODE V lens file that cannot be read, because it describes
/// more than a lens of surfaces centred on one axis.
[[noreturn]] void seq_unsupported(const std::string& file, int line, std::string_view what);

}  // namespace postlens
