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
    /// The words of the command line with which the command is run for measurements. Omitted are --share,
    /// --dry-run, and the options that name output files, because measurements write only temporary files.
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

/// Predicts the time and memory that each machine needs for its share of the command, and returns them as
/// JSON. To measure these, runs the command with fewer samples, views or frames in separate processes. These
/// write only to a temporary folder.
[[nodiscard]] CommandResult dry_run(const DryRun& work);

}  // namespace postlens
