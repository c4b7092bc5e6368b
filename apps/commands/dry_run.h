// Predicts the outputs, memory and time of a command. If the command is divided into several tasks (shares),
// there is one prediction per task.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// A command for which `--dry-run` predicts the tasks.
struct DryRun {
    /// The words of the command, without --share, --dry-run and the output (words_of).
    std::vector<std::string> words;
    std::string output;
    int shares = 1;
    bool by_samples = false;                          ///< shares are samples of every pixel
    std::optional<std::vector<int>> frames;           ///< shares are frames
    std::function<std::string(int frame)> output_of;  ///< with `frames`: returns the output file of a frame
    int pictures = 0;  ///< for a sweep, the number of its images, which are divided into shares; otherwise 0
    /// Name of the option that sets the number of samples or views (`amount`), such as --spp. The time
    /// depends on this number linearly. The name is empty if the command has no such option.
    std::string amount_option;
    int amount = 0;
};

/// Predicts the tasks and returns them as JSON. Small parts of the command are run in separate processes,
/// which write only to a temporary folder, and their time and memory are measured. A small part has, for
/// example, only a few samples or frames. The cost of the whole is computed from these measurements. Throws
/// the errors of the command.
[[nodiscard]] CommandResult dry_run(const DryRun& work);

}  // namespace postlens
