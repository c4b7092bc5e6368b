// Splits an NFF file into words, in bounded memory for any content.
#pragma once

#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "scene/file_digest.h"

namespace postlens {

/// The words of a file, without comments. Computes the file's SHA-256 while reading.
class NffTokens {
  public:
    /// Throws Error(invalid_input) if the path is no readable file.
    explicit NffTokens(const std::filesystem::path& path);

    /// The next word, on this line or a later one; empty at the end of the file. Valid until the next line is
    /// read.
    [[nodiscard]] std::optional<std::string_view> next();
    /// The word that `next` would return, which is not taken.
    [[nodiscard]] std::optional<std::string_view> peek();
    /// Takes the remaining words on the line of the last word taken.
    [[nodiscard]] std::vector<std::string> rest_of_line();

    /// Takes the next word as a finite number of at most `largest` in magnitude. `what` names it in errors.
    [[nodiscard]] double number(std::string_view what, double largest);
    /// Converts a word that was already taken.
    [[nodiscard]] double number(std::string_view word, std::string_view what, double largest) const;

    /// Line of the last word taken, from 1.
    [[nodiscard]] int line() const { return taken_line_; }
    /// SHA-256 of the whole file. Call once, at the end of the file.
    [[nodiscard]] std::string sha256() { return digest_.hex(); }

    /// Throws Error(invalid_input) "FILE:LINE: ..." for the line of the last word taken.
    template <typename... Args>
    [[noreturn]] void fail_here(fmt::format_string<Args...> format, Args&&... args) const {
        fail(ExitCode::invalid_input, "{}:{}: {}", path_.string(), taken_line_,
             fmt::format(format, std::forward<Args>(args)...));
    }

  private:
    bool read_line();
    bool fill();

    std::filesystem::path path_;
    std::ifstream file_;
    Sha256 digest_;
    std::string chunk_;
    std::size_t chunk_at_ = 0;
    std::string text_;
    std::vector<std::string_view> words_;  ///< words of the current line, in text_
    std::size_t word_at_ = 0;
    int line_ = 0, taken_line_ = 1;
};

}  // namespace postlens
