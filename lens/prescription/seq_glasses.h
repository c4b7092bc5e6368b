// Glasses of CODE V sequence files. A file refers to a glass by its catalogue name, by a code of its index nd
// and Abbe number Vd, or by the name of a private glass that the file defines. Only the parser of these files
// includes this header.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lens/prescription/glass.h"
#include "lens/prescription/seq_text.h"

namespace postlens {

class SeqGlasses {
  public:
    /// `file`: the file name for error messages.
    explicit SeqGlasses(std::string file) : file_(std::move(file)) {}
    /// Reads a command from the block of private glasses, between PRV and END. The command defines a glass,
    /// or the wavelengths for the indices in later commands. If a glass cannot be read, `find` throws when a
    /// surface uses the glass.
    void define(int line, const std::string& key, const SeqWords& words);
    /// Finds a glass by its catalogue name, by the name of a private glass, or by a code of its index nd and
    /// Abbe number Vd. Examples of codes are "517642", "517.642", "516800.641700" and "1.5168:64.17". Throws
    /// Error(invalid_input) if the glass is unknown.
    [[nodiscard]] Glass find(int line, std::string_view word) const;

  private:
    void define_by_formula(int line, const std::string& key, const std::string& formula,
                           std::vector<double> terms);

    std::string file_;
    std::vector<double> wavelengths_nm_;
    std::map<std::string, Glass> private_;
    std::map<std::string, std::string> unread_;  ///< reason why a private glass could not be read
};

}  // namespace postlens
