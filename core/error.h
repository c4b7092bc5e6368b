// The exception type of postlens, with one line of text and an exit code.
#pragma once

#include <fmt/format.h>
#include <stdexcept>
#include <string>
#include <utility>

namespace postlens {

/// Exit codes of the command. Each kind of failure has its own code.
enum class ExitCode : int {
    ok = 0,
    comparison_failed = 1,
    wrong_arguments = 2,
    invalid_input = 3,
    cannot_write = 4,
    out_of_memory = 5,
    shortfall = 6,  ///< the output is written, but misses a target or limit
    interrupted = 130,
};

/// Thrown for invalid input, files and arguments. `what()` is one line: "FILE:LINE: what is wrong (got X;
/// expected Y)".
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}
    [[nodiscard]] ExitCode code() const { return code_; }

  private:
    ExitCode code_;
};

template <typename... Args>
[[noreturn]] void fail(ExitCode code, fmt::format_string<Args...> format, Args&&... args) {
    throw Error(code, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace postlens
