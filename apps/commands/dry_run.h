// Predicts the tasks of a command, with the outputs, memory and seconds of each task. A command may be
// divided into several tasks (shares).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// A command for which `--dry-run` predicts the tasks.
struct DryRun {
    /// the words of the command, without --share, --dry-run and output (words_of)
    std::vector<std::string> words;
    std::string output;
    int shares = 1;
    bool by_samples = false;                          ///< shares are samples of every pixel
    std::optional<std::vector<int>> frames;           ///< shares are frames
    std::function<std::string(int frame)> output_of;  ///< with `frames`: returns the output file of a frame
    int pictures = 0;  ///< for a sweep, the number of its images, which are divided into shares; otherwise 0
    /// Name of the option, such as --spp, on whose value (`amount`) the seconds depend linearly. Empty if
    /// there is no such option.
    std::string amount_option;
    int amount = 0;
};

/// Returns the predicted tasks as JSON. Runs small parts of the command in separate processes and measures
/// their seconds and memory. A small part has few samples, or only some of the frames, images or rows. The
/// costs of all other parts are interpolated or extrapolated linearly. Writes only to a temporary folder.
/// Throws the errors of the command.
[[nodiscard]] CommandResult dry_run(const DryRun& work);

}  // namespace postlens
