// Finds the glasses of CODE V sequence files. A file names a glass by its catalogue name, by its refractive
// index and Abbe number, or by a private name that the file defines.
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
    /// Reads one line of a glass definition in a CODE V lens file (.seq). Such a file may define glasses of
    /// its own, between the commands PRV and END. If a definition cannot be read, this is an error only if a
    /// lens surface uses the glass.
    void define(int line, const std::string& key, const SeqWords& words);
    /// Finds a glass by its catalogue name, its private name, or a code of index and Abbe number ("517642",
    /// "517.642" or "1.5168:64.17"). Throws Error(invalid_input) if it is unknown.
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
