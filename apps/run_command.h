// Runs commands within the process, for the program, the C++ interface and the Python module.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/cli.h"
#include "apps/open_frame.h"

namespace postlens {

/// Calls `command.run` in the calling thread, for the current job, and adds `seconds` to the JSON.
[[nodiscard]] CommandResult run_timed(const ParsedCommand& command);

/// Parses and runs a command as run_timed does. `words` are the arguments after the name of the program.
/// The call waits until no other call uses the file `in_process.kept`.
[[nodiscard]] CommandResult run_command(std::vector<std::string> words, const InProcess& in_process);

/// Returns the JSON that `--json` prints: the JSON of the result, the peak memory of the process, and the
/// warnings.
[[nodiscard]] nlohmann::ordered_json report_json(const CommandResult& result);

}  // namespace postlens
