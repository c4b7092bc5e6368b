/// @file
/// Errors: one exception type, one line of text, one exit code.
#pragma once

#include <stdexcept>
#include <string>

/// The project's namespace. Programs use only `postlens::api`, the namespace of the installed headers.
namespace postlens {}

/// The public interface: the commands of `postlens` as functions.
///
/// Every function runs the command of its name inside the calling process. Settings have the names of the
/// command's options, with the unit as the last word; a setting that is not given has the command's default.
/// `postlens COMMAND --help` states the bounds. Paths are those of the file system, relative ones from the
/// current folder.
///
/// Errors: every function throws `Error` and no other exception. What a function writes to a file is
/// complete, or the file stays as it was.
///
/// Threads: functions may be called at once from several threads, each with a `Job` of its own. Pictures have
/// the same bits for any number of threads.
namespace postlens::api {

/// The command's exit codes. Codes 0, 1 and 6 are results (`Report::exit_code`), the others are errors
/// (`Error::code`).
enum class ExitCode {
    ok = 0,                 ///< The work is done.
    comparison_failed = 1,  ///< A figure of `compare` misses its limit.
    wrong_arguments = 2,    ///< A setting is out of range, unknown, missing or excluded by another one.
    invalid_input = 3,      ///< A file is missing, unreadable, damaged or of the wrong kind.
    cannot_write = 4,       ///< A file cannot be written; no part of it remains.
    out_of_memory = 5,      ///< The work needs more memory than there is. Mostly found before it begins.
    shortfall = 6,          ///< The picture is made, but misses `target_db`, or with `--strict` the file
                            ///< does not suffice for the lens or the shutter.
    interrupted = 130,      ///< The job was cancelled.
};

/// The exception of every function in this namespace. `what()` is one line, "FILE:LINE: what is wrong (got X;
/// expected Y)". Messages name settings as the command's options: `--f-number` is `f_number`.
class Error : public std::runtime_error {
  public:
    /// Makes an error.
    /// @param code The exit code with which the command would end.
    /// @param text One line of text.
    Error(ExitCode code, const std::string& text) : std::runtime_error(text), code_(code) {}

    /// @return The exit code with which the command would end.
    [[nodiscard]] ExitCode code() const noexcept { return code_; }

  private:
    ExitCode code_;
};

}  // namespace postlens::api
