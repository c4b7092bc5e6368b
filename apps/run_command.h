// Runs commands within the process, for the program, the C++ interface and the Python module.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/cli.h"
#include "apps/open_frame.h"

namespace postlens {

/// Runs the command in the calling thread. Its progress and cancellation are those of the current job
/// (core/job.h). Adds the running time in `seconds` to the JSON.
[[nodiscard]] CommandResult run_timed(const ParsedCommand& command);

/// Parses `words`, the arguments after the name of the program, and runs the command (run_timed).
/// `in_process.kept` may contain an open sample file, which several calls share. Only one of them at a time
/// can use it, so this call first waits until no other uses it.
[[nodiscard]] CommandResult run_command(std::vector<std::string> words, const InProcess& in_process);

/// Returns the JSON text that `--json` prints: the result, the peak memory of the process, and the warnings.
/// Invalid UTF-8 in names becomes U+FFFD, because JSON must be UTF-8.
[[nodiscard]] std::string report_json(const CommandResult& result);

}  // namespace postlens
