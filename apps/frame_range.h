// Ranges of frames: which ones, what their files are called, and one command run for each.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// "1-48", "1-48x2" (every second), "1,5,9", or several of these joined by commas: whole numbers from 0 to
/// 9999999, each once, in the order given, up to a million. Throws Error(wrong_arguments) naming the option.
[[nodiscard]] std::vector<int> parse_frames(std::string_view option, std::string_view text);

/// A file name that may hold the frame's number: %d, or %04d with leading zeros (1 to 9 digits), wherever it
/// stands; every other % is itself. Without one, and where `hashes` are allowed, each run of # in the last
/// part of the path stands for the number with as many digits.
class FrameName {
  public:
    FrameName(std::string_view text, bool hashes);
    [[nodiscard]] bool has_number() const { return !digits_.empty(); }
    [[nodiscard]] std::string of(int frame) const;

  private:
    std::vector<std::string> words_;  ///< between the numbers: one more than there are of them
    std::vector<int> digits_;         ///< at least so many, of each number
};

/// What is asked for besides the command's own options.
struct FrameOptions {
    std::optional<std::vector<int>> frames;
    std::optional<double> fps;  ///< of trace and render; absent: 24
    bool keep = false;          ///< leave out frames whose output is there and whole
    bool speak = false;         ///< a line on standard output as each frame is done
};

/// The files of one frame, or their names with a number in them.
struct FrameFiles {
    std::string input, output;
    std::optional<std::string> explain;  ///< another picture to write
    bool halves = false;                 ///< and two more beside the output (tracer/render.h)
    std::vector<std::string> passes;     ///< of the input, in files of their own; empty texts: none
};

/// Throws Error(wrong_arguments) where a name holds a number, or an option was given, that means nothing
/// without --frames.
void refuse_frames(const FrameOptions& options, const FrameFiles& names);

/// Runs the command for each frame. `in_time`: frames differ by their time as well, so that the input need
/// not hold a number. An error names its frame and ends the range; the exit code is the first that is not 0.
/// Throws Error(wrong_arguments) for names without a number, before any work, and what `run` throws.
[[nodiscard]] CommandResult run_frame_range(
    const FrameOptions& options, const FrameFiles& names, bool in_time,
    const std::function<CommandResult(const FrameFiles& files, int frame)>& run);

// The commands, for one picture or for a range (frame_commands.cpp).
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const TraceOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const RenderOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const ImageOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const FocusOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const MotionBlurOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const ShootOptions& asked);

}  // namespace postlens
