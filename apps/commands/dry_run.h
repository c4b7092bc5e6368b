// Predicts what a command would do, divided into shares or not: its tasks, and the outputs, memory and
// seconds of each task.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// A command for which `--dry-run` predicts the tasks.
struct DryRun {
    std::vector<std::string> words;  ///< the command, without --share, --dry-run and output (words_of)
    std::string output;
    int shares = 1;
    bool by_samples = false;                          ///< shares are samples of every pixel
    std::optional<std::vector<int>> frames;           ///< shares are frames
    std::function<std::string(int frame)> output_of;  ///< with `frames`: the file of a frame
    int pictures = 0;  ///< number of images of a sweep, whose shares are images; else 0
    /// Option on whose value (`amount`) the seconds depend linearly, such as --spp; empty: none.
    std::string amount_option;
    int amount = 0;
};

/// Predicts the tasks, as JSON. Runs small parts of the command in separate processes (few samples or views;
/// some of the frames, images or shares) and measures their seconds and memory. The costs of all other parts
/// are interpolated or extrapolated linearly from these. Writes only to a temporary folder. Throws the errors
/// of the command.
[[nodiscard]] CommandResult dry_run(const DryRun& work);

}  // namespace postlens
