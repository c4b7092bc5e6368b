// Predicts the outputs, memory and time of a command. If the command is divided into several tasks (shares),
// there is one prediction per task.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// A command whose time and memory `--dry-run` predicts.
struct DryRun {
    /// The words of the command line, without --share, --dry-run and the options with output names.
    std::vector<std::string> words;
    std::string output;
    int shares = 1;
    bool by_samples = false;                          ///< shares are samples of every pixel
    std::optional<std::vector<int>> frames;           ///< shares are frames
    std::function<std::string(int frame)> output_of;  ///< with `frames`: returns the output file of a frame
    int pictures = 0;  ///< for a sweep, the number of its images, which are divided into shares; otherwise 0
    /// Name of the option for the number of samples or views, such as --spp. The time of the command is
    /// assumed to grow linearly with this number. Empty if the command has no such option.
    std::string amount_option;
    int amount = 0;
};

/// Predicts the time and memory of each task, and returns them as JSON. To measure them, it runs small
/// versions of the command, for example with few samples or a single frame. These run in separate processes,
/// which write only to a temporary folder. If such a run fails, throws its error.
[[nodiscard]] CommandResult dry_run(const DryRun& work);

}  // namespace postlens
