// Frame ranges: parses ranges, names the files of each frame, and runs a command for each frame.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// Parses frame numbers such as "1-48", "1-48x2" (every second frame), "1,5,9" or several of these joined by
/// commas, and keeps their order. Accepts up to a million different integers from 0 to 9999999. Throws
/// Error(wrong_arguments) with the name of the option.
[[nodiscard]] std::vector<int> parse_frames(std::string_view option, std::string_view text);

/// A file name with placeholders for the frame number: %d, or %04d with leading zeros (1 to 9 digits). Any
/// other % is an ordinary character. If `hashes` is set and there is no % placeholder, each run of # in the
/// last part of the path is a placeholder with one digit per #.
class FrameName {
  public:
    FrameName(std::string_view text, bool hashes);
    [[nodiscard]] bool has_number() const { return !digits_.empty(); }
    [[nodiscard]] std::string of(int frame) const;

  private:
    /// text around the placeholders; one entry more than there are placeholders
    std::vector<std::string> words_;
    std::vector<int> digits_;  ///< least number of digits of each placeholder
};

/// Options of frame ranges, in addition to the command's own.
struct FrameOptions {
    std::optional<std::vector<int>> frames;
    std::optional<double> fps;  ///< for trace and render; absent: 24
    bool keep =
        false;  ///< skip a frame if its output is complete and was made from the same inputs and options
    /// Returns the fingerprint (AskedFor) of the command for one frame. It is written to the file of the
    /// frame.
    std::function<nlohmann::ordered_json(int frame)> asked_for;
    /// With a range, selects every N-th frame. Without a range, selects a part of the image.
    std::optional<SharedWork> shared;
    bool speak = false;  ///< print a line after each frame
};

/// The files of one frame, or their names with placeholders.
struct FrameFiles {
    std::string input, output;
    std::optional<std::string> explain;  ///< explanation image to write
    bool halves = false;                 ///< also writes the two halves (tracer/render.h)
    /// separate files with depths, ids and other channels of the input; may be empty
    std::vector<std::string> passes;
};

/// Throws Error(wrong_arguments) if a file name has a placeholder, or if an option that needs --frames is
/// set.
void refuse_frames(const FrameOptions& options, const FrameFiles& names);

/// Runs the command for each frame. `in_time`: the instant differs between frames, so the input name needs no
/// placeholder. `run` also receives the text for Image::made_by. With --keep, a frame is kept if its file
/// states the same fingerprint. Otherwise the frame is made again, with a warning that names the differing
/// setting. An error names its frame and ends the range. The exit code is the first nonzero one. Throws the
/// errors of `run`. Before any work, throws Error(wrong_arguments) for names without a placeholder.
[[nodiscard]] CommandResult run_frame_range(
    const FrameOptions& options, const FrameFiles& names, bool in_time,
    const std::function<CommandResult(const FrameFiles& files, int frame, const std::string& made_by)>& run);

// Run a command for one frame or for a range (frame_commands.cpp).
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const TraceOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const RenderOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const ImageOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const FocusOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const MotionBlurOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const ShootOptions& asked);

}  // namespace postlens
