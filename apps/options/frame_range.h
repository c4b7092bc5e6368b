// Parses frame ranges, names the files of each frame, and runs a command for each frame.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/command.h"

namespace postlens {

/// Parses frame numbers such as "1-48", "1-48x2" (every second frame), "1,5,9" or combinations. The order is
/// kept, and no number may occur twice. Throws Error(wrong_arguments), which names the option.
[[nodiscard]] std::vector<int> parse_frames(std::string_view option, std::string_view text);

/// A file name with placeholders for the frame number. %d stands for the number, and %04d for the number with
/// at least 4 digits (leading zeros). If `hashes` is true and there is no such placeholder, a run of # in the
/// last part of the path is the placeholder.
class FrameName {
  public:
    FrameName(std::string_view text, bool hashes);
    [[nodiscard]] bool has_number() const { return !digits_.empty(); }
    [[nodiscard]] std::string of(int frame) const;

  private:
    /// The parts of the file name before, between and after the placeholders for the frame number.
    std::vector<std::string> words_;
    std::vector<int> digits_;  ///< least number of digits of each placeholder
};

/// Options for a range of frames, in addition to those of the command itself.
struct FrameOptions {
    std::optional<std::vector<int>> frames;
    std::optional<double> fps;  ///< for trace and render; 24 if absent
    bool keep =
        false;  ///< skip a frame if its output is complete and was made from the same inputs and options
    /// Returns the options and inputs on which a frame's result depends. They are stored in the frame's
    /// output file.
    std::function<nlohmann::ordered_json(int frame)> asked_for;
    /// The part of the work that this machine does, if several machines divide it. With --frames, it is every
    /// N-th frame. Without --frames, it is a part of the image.
    std::optional<SharedWork> shared;
    bool speak = false;  ///< print a line after each frame
};

/// The files of one frame. For a range of frames, their names contain placeholders for the frame number.
struct FrameFiles {
    std::string input, output;
    std::optional<std::string> explain;  ///< explanation image to write
    bool halves = false;                 ///< also writes the two halves (tracer/render.h)
    /// Names of the files that contain the depths, object ids and further channels of the frame, if these are
    /// not in the file `input`. A name is empty if there is no such file.
    std::vector<std::string> passes;
};

/// Checks a command that is used without --frames, that is, for a single frame. Throws Error(wrong_arguments)
/// if a file name contains a placeholder for the frame number, or if --keep or --fps is given, because these
/// are useful only for several frames.
void refuse_frames(const FrameOptions& options, const FrameFiles& names);

/// Runs the command for each frame by calling `run`, which also receives the text for Image::made_by. If
/// `in_time` is set, the frames are instants of one input, so the input name needs no placeholder.
///
/// With --keep, a frame is skipped if its file has the same fingerprint as the command. If the fingerprint
/// differs, the frame is made again, and a warning names the setting that differs. An error ends the range.
/// The exit code is the first one that is not zero. Throws Error(wrong_arguments) before any work if a name
/// lacks a placeholder. Also throws the errors of `run`.
[[nodiscard]] CommandResult run_frame_range(
    const FrameOptions& options, const FrameFiles& names, bool in_time,
    const std::function<CommandResult(const FrameFiles& files, int frame, const std::string& made_by)>& run);

// These functions run a command for one frame or for a range of frames (frame_commands.cpp).
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const TraceOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const RenderOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const ImageOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const FocusOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const MotionBlurOptions& asked);
[[nodiscard]] CommandResult run_frames(const FrameOptions& frames, const ShootOptions& asked);

}  // namespace postlens
