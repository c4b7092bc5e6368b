// The readers behind read_prescription, one per format: text in, prescription out, not yet checked as a
// whole. Used by read_prescription.cpp and the readers only.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "lens/prescription/prescription.h"

namespace postlens {

// `file` is how errors call it. All throw Error(invalid_input) "FILE:LINE: ...".
[[nodiscard]] Prescription parse_dat(const std::string& text, const std::string& file);
[[nodiscard]] Prescription parse_zmx(const std::string& text, const std::string& file);
[[nodiscard]] Prescription parse_seq(const std::string& text, const std::string& file);
[[nodiscard]] Prescription parse_lens_toml(const std::string& text, const std::string& file);

/// A line of a text and what stands in it.
struct TextLine {
    int number = 0;  ///< from 1
    std::string_view text;
};

/// Lines without their ends, "\n", "\r\n" or "\r".
[[nodiscard]] std::vector<TextLine> lines_of(std::string_view text);

/// Words between blanks and tabs; a text in double or single quotes is one word, without them.
[[nodiscard]] std::vector<std::string_view> words_of(std::string_view line);

/// Throws "FILE:LINE: WHAT is not a finite number (got ...; expected a number)".
double number_in(const std::string& file, int line, std::string_view word, std::string_view what);

/// Throws where one more surface would be too many.
void check_surface_count(const std::string& file, int line, std::size_t count);

/// A known glass, or "FILE:LINE: unknown glass ...".
[[nodiscard]] Glass glass_by_name(const std::string& file, int line, std::string_view name);

}  // namespace postlens
