// Splits an NFF file into words. Memory use is limited, whatever the file contains.
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

/// The words of a file, without comments. Computes the SHA-256 of the file while reading.
class NffTokens {
  public:
    /// Throws Error(invalid_input) if the path is not a readable file.
    explicit NffTokens(const std::filesystem::path& path);

    /// Returns the next word, also from a later line, and moves past it. Empty at the end of the file.
    /// The word is valid until the next line is read.
    [[nodiscard]] std::optional<std::string_view> next();
    /// Returns the word that `next` would return, without moving past it.
    [[nodiscard]] std::optional<std::string_view> peek();
    /// Returns the remaining words on the line of the last word.
    [[nodiscard]] std::vector<std::string> rest_of_line();

    /// Returns the next word as a finite number, whose absolute value must not exceed `largest`.
    /// `what` describes the number in error messages.
    [[nodiscard]] double number(std::string_view what, double largest);
    /// Converts a word that `next` has returned to a number.
    [[nodiscard]] double number(std::string_view word, std::string_view what, double largest) const;

    /// Returns the line number, from 1, of the last word that `next` has returned from the NFF file.
    [[nodiscard]] int line() const { return taken_line_; }
    /// Returns the SHA-256 of the whole file. Call it only once, at the end of the file.
    [[nodiscard]] std::string sha256() { return digest_.hex(); }

    /// Throws Error(invalid_input) "FILE:LINE: ..." with the line number of the last word that was taken.
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
