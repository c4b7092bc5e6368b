// Parsers of the prescription formats. They do not check whether the whole prescription is valid;
// read_prescription does.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "lens/prescription/prescription.h"

namespace postlens {

// Parsers of lens files in four formats: .dat, .zmx, .seq and .toml. `text` is the content of a file, and
// `file` is its name for error messages. If the text is invalid, they throw Error(invalid_input) with a
// message that begins with "FILE:LINE: ".
[[nodiscard]] Prescription parse_dat(const std::string& text, const std::string& file);
[[nodiscard]] Prescription parse_zmx(const std::string& text, const std::string& file);
[[nodiscard]] Prescription parse_seq(const std::string& text, const std::string& file);
[[nodiscard]] Prescription parse_lens_toml(const std::string& text, const std::string& file);

/// A line of a text and its number.
struct TextLine {
    int number = 0;  ///< from 1
    std::string_view text;
};

/// Splits text into lines at "\n", "\r\n" or "\r", which are removed.
[[nodiscard]] std::vector<TextLine> lines_of(std::string_view text);

/// Splits a line into words at blanks and tabs. Text in quotes is one word, without the quotes.
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view line);

/// Parses a word as a number. Throws "FILE:LINE: WHAT is not a finite number (got ...; expected a number)".
double number_in(const std::string& file, int line, std::string_view word, std::string_view what);

/// Throws if `count` surfaces have already reached the limit most_surfaces.
void check_surface_count(const std::string& file, int line, std::size_t count);

/// Throws if the medium between the object and the lens is not air.
void check_object_medium(const std::string& file, const Surface& object);

/// Finds a glass by name. Throws "FILE:LINE: unknown glass ..." if the name is unknown.
[[nodiscard]] Glass glass_by_name(const std::string& file, int line, std::string_view name);

}  // namespace postlens
