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
    int threads = 0;  ///< 0 means one per core
    bool quiet = false;
    bool json = false;
    Join join = Join::no;  ///< set by `merge`, to only join the results of the shares (the parts of the work)
    bool dry_run = false;  ///< predict files, memory and time instead of running the command
    int requeue_code = 75;  ///< exit code if a signal of the batch system ends the command (core/signals.h)
};

/// Settings for a command that other code, such as the viewer, runs without a command line.
struct InProcess {
    bool pictures_stay = false;       ///< makes --output optional; without it the image is returned
    std::shared_ptr<KeptFrame> kept;  ///< the sample file of the command, if it is already open
    Join join = Join::no;             ///< ParsedCommand::join
};

/// Parses the arguments of the program, without the name of the program. Throws Error(wrong_arguments) with a
/// message of one line.
[[nodiscard]] ParsedCommand parse_command_line(std::vector<std::string> arguments,
                                               const InProcess& in_process = {});

}  // namespace postlens
