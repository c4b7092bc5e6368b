// The command line: every subcommand and option, parsed into a call that is ready to run.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

struct ParsedCommand {
    std::function<CommandResult()> run;  ///< empty: only `text` is to be shown (--help, --version)
    std::string text;
    int threads = 0;  ///< 0: all
    bool quiet = false;
    bool json = false;
};

/// For a caller in the same process.
struct InProcess {
    bool pictures_stay = false;       ///< without --output the picture stays in the result
    std::shared_ptr<KeptFrame> kept;  ///< the sample file that the command names
};

/// `arguments` without the program's name. Throws Error(wrong_arguments), one line.
[[nodiscard]] ParsedCommand parse_command_line(std::vector<std::string> arguments,
                                               const InProcess& in_process = {});

}  // namespace postlens
