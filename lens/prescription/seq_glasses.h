// Glasses of CODE V sequence files: private definitions, codes of nd and Vd, and catalogue names. Only the
// reader of these files includes this header.
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
    /// Reads a command between PRV and END, which defines a private glass or the wavelengths of its indices.
    /// An unreadable glass is an error only if a surface uses it, that is in `find`.
    void define(int line, const std::string& key, const SeqWords& words);
    /// Finds a glass by its catalogue name, the name of a private glass, or a code of nd and Vd: "517642",
    /// "517.642", "516800.641700" or "1.5168:64.17". Throws Error(invalid_input) if there is none.
    [[nodiscard]] Glass find(int line, std::string_view word) const;

  private:
    void define_by_formula(int line, const std::string& key, const std::string& formula,
                           std::vector<double> terms);

    std::string file_;
    std::vector<double> wavelengths_nm_;
    std::map<std::string, Glass> private_;
    std::map<std::string, std::string> unread_;  ///< private glasses that could not be read, and the reason
};

}  // namespace postlens
