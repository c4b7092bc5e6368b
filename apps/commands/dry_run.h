// What a command would do, in shares or at once: its tasks, their outputs, memory and seconds.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// A command line that `--dry-run` looks at.
struct DryRun {
    std::vector<std::string> words;  ///< the command, without --share, --dry-run and output (words_of)
    std::string output;
    int shares = 1;
    bool by_samples = false;                          ///< shares are samples of every pixel
    std::optional<std::vector<int>> frames;           ///< shares are frames
    std::function<std::string(int frame)> output_of;  ///< with `frames`: their files
    int pictures = 0;                                 ///< of a sweep, whose shares are pictures; else 0
    /// Option in which the seconds are linear, such as --spp, and its value; empty: none.
    std::string amount_option;
    int amount = 0;
};

/// Tells the tasks, as JSON: runs parts of the command as programs of their own, with few samples or views,
/// some of the frames, pictures or shares, and measures them. What it does not run it takes from those by
/// straight lines. Nothing is written but in a temporary folder. Throws the errors of the command.
[[nodiscard]] CommandResult dry_run(const DryRun& work);

}  // namespace postlens
