// Predicts the outputs, memory and time of a command, for each task (share) into which it is divided.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// A command whose time and memory `--dry-run` predicts.
struct DryRun {
    /// The words of the command line, without --share, --dry-run and the options that name output files.
    std::vector<std::string> words;
    std::string output;
    int shares = 1;
    bool by_samples = false;                          ///< shares are samples of every pixel
    std::optional<std::vector<int>> frames;           ///< shares are frames
    std::function<std::string(int frame)> output_of;  ///< with `frames`: returns the output file of a frame
    int pictures = 0;  ///< for a sweep, the number of its images, which are divided into shares; otherwise 0
    /// Name of the option for the number of samples or views, such as --spp, on which the command's time
    /// depends linearly. Empty if there is none.
    std::string amount_option;
    int amount = 0;
};

/// Predicts the time and memory of each task, and returns them as JSON. Measures small versions of the
/// command in separate processes, which write only to a temporary folder.
[[nodiscard]] CommandResult dry_run(const DryRun& work);

}  // namespace postlens
