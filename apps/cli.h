// Parses the command line: all subcommands and options.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

struct ParsedCommand {
    std::function<CommandResult()> run;  ///< empty if only `text` is to be printed (--help, --version)
    std::string text;
    int threads = 0;  ///< 0: one per core
    bool quiet = false;
    bool json = false;
    Join join = Join::no;   ///< for `merge`: the command only joins what its shares have made
    bool dry_run = false;   ///< predicts files, memory and time instead of running the command
    int requeue_code = 75;  ///< exit code if a batch system's signal ends the command (core/signals.h)
};

/// Settings for a caller in the same process, such as the viewer.
struct InProcess {
    bool pictures_stay = false;       ///< makes --output optional; without it the image is returned
    std::shared_ptr<KeptFrame> kept;  ///< the command's sample file, if it is open already
    Join join = Join::no;             ///< ParsedCommand::join
};

/// `arguments` excludes the name of the program. Throws Error(wrong_arguments) with a one-line text.
[[nodiscard]] ParsedCommand parse_command_line(std::vector<std::string> arguments,
                                               const InProcess& in_process = {});

}  // namespace postlens
