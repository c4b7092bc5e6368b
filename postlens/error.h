/// @file
/// The exception of the public interface. An error has one line of text and an exit code.
#pragma once

#include <stdexcept>
#include <string>

/// The namespace of the project. Programs should use only the namespace `postlens::api`, which contains
/// everything that the installed headers declare.
namespace postlens {}

/// The public interface: the commands of `postlens` as functions.
///
/// Every function runs the command of the same name inside the calling process. Settings have the names of
/// the command's options, with the unit as the last word. A setting that is not given has the same default as
/// in the command. `postlens COMMAND --help` states the accepted values. Relative paths start at the current
/// folder.
///
/// Errors: every function throws `Error` and no other exception. A file is either written completely or left
/// unchanged.
///
/// Threads: several threads may call functions at the same time if each has its own `Job`. Pictures are
/// bit-identical for any number of threads.
namespace postlens::api {

/// The exit codes of the command. Functions return codes 0, 1 and 6 as `Report::exit_code`. In all other
/// cases, they throw an Error with the code (`Error::code`).
enum class ExitCode {
    ok = 0,                 ///< The work is done.
    comparison_failed = 1,  ///< The error that `compare` measures exceeds a limit.
    /// A setting is out of range, unknown or missing, or must not be combined with another one.
    wrong_arguments = 2,
    invalid_input = 3,  ///< A file is missing, unreadable, damaged or of the wrong kind.
    cannot_write = 4,   ///< A file cannot be written. No part of it remains.
    /// The work needs more memory than is available. In most cases, this is found before the work begins.
    out_of_memory = 5,
    /// The picture was made completely, but its measured PSNR is below the wanted one, `target_db`. If the
    /// option `--strict` is given, this code can also mean that there was a warning.
    shortfall = 6,
    interrupted = 130,  ///< The job was cancelled.
};

/// The exception that every function in this namespace throws. `what()` is one line of the form "FILE:LINE:
/// what is wrong (got X; expected Y)". If a field of a settings struct has a wrong value, the line names the
/// corresponding option of the command line, for example `--f-number` for the field `f_number`.
class Error : public std::runtime_error {
  public:
    /// Makes an error.
    /// @param code The exit code that the command would have.
    /// @param text One line of text.
    Error(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}

    /// @return The exit code that the command would have.
    [[nodiscard]] ExitCode code() const noexcept { return code_; }

  private:
    ExitCode code_;
};

}  // namespace postlens::api
