// The words of an NFF file, read in bounded memory whatever the file holds.
#pragma once

#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "tracer/file_digest.h"

namespace postlens {

/// Words of the file line by line, without comments. The file's SHA-256 is taken on the way.
class NffTokens {
  public:
    /// Throws Error(invalid_input) where the path is no readable file.
    explicit NffTokens(const std::filesystem::path& path);

    /// The next word, on this line or a later one; empty at the end of the file. Valid until the next line is
    /// read.
    [[nodiscard]] std::optional<std::string_view> next();
    /// As `next`, without taking it.
    [[nodiscard]] std::optional<std::string_view> peek();
    /// Takes what is left on the line of the last word taken.
    [[nodiscard]] std::vector<std::string> rest_of_line();

    /// The next word as a finite number of at most `largest` in magnitude; `what` names it in the error.
    [[nodiscard]] double number(std::string_view what, double largest);
    /// As `number` for a word already taken.
    [[nodiscard]] double number(std::string_view word, std::string_view what, double largest) const;

    /// Of the last word taken, from 1.
    [[nodiscard]] int line() const { return taken_line_; }
    /// Of the whole file; call at its end.
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
    std::vector<std::string_view> words_;  ///< of text_
    std::size_t word_at_ = 0;
    int line_ = 0, taken_line_ = 1;
};

}  // namespace postlens
