// The parsers behind read_prescription, one per format. They do not check the prescription as a whole. Only
// read_prescription.cpp and the parsers include this header.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "lens/prescription/prescription.h"

namespace postlens {

// `file` is the file name for error messages. All parsers throw Error(invalid_input) "FILE:LINE: ...".
[[nodiscard]] Prescription parse_dat(const std::string& text, const std::string& file);
[[nodiscard]] Prescription parse_zmx(const std::string& text, const std::string& file);
[[nodiscard]] Prescription parse_seq(const std::string& text, const std::string& file);
[[nodiscard]] Prescription parse_lens_toml(const std::string& text, const std::string& file);

/// A line of a text and its number.
struct TextLine {
    int number = 0;  ///< from 1
    std::string_view text;
};

/// Splits a text at its line ends, "\n", "\r\n" or "\r", and removes them.
[[nodiscard]] std::vector<TextLine> lines_of(std::string_view text);

/// Splits a line at blanks and tabs. Text in double or single quotes is one word, without the quotes.
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view line);

/// Parses a word as a number, or throws "FILE:LINE: WHAT is not a finite number (got ...; expected a
/// number)".
double number_in(const std::string& file, int line, std::string_view word, std::string_view what);

/// Throws if one more surface than `count` exceeds the limit.
void check_surface_count(const std::string& file, int line, std::size_t count);

/// Returns the glass of that name, or throws "FILE:LINE: unknown glass ...".
[[nodiscard]] Glass glass_by_name(const std::string& file, int line, std::string_view name);

}  // namespace postlens
