// The options of the subcommands, and the functions that add the subcommands to the parser.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/commands/dry_run.h"
#include "apps/options/cli_options.h"
#include "apps/options/frame_range.h"
#include "apps/view/view_command.h"
#include "apps/view/view_export.h"

namespace postlens {

inline constexpr const char* exposure_of_file = "the sample file's; 0 of another program's picture";

struct CommandOptions {
    ParsedCommand common;
    TraceOptions trace;
    RenderOptions render;
    FocusOptions focus;
    MotionBlurOptions motionblur;
    ShootOptions shoot;
    RecordsOptions records;
    CompareCommandOptions compare;
    ImageOptions image;
    InfoOptions info;
    ViewOptions view;
    ViewExportOptions export_view;
    FrameOptions frames;
    std::optional<Share> share;
    MergeOptions merge;
    /// Returns the options for a command that processes several frames (--frames). The option `speak`, which
    /// prints a line after each frame, is set here: to false with --quiet or --json, and otherwise to true.
    [[nodiscard]] const FrameOptions& asked_frames() {
        frames.speak = !common.quiet && !common.json;
        return frames;
    }
};

// Declare subcommands.
void add_trace(CLI::App& root, CommandOptions& s);
void add_render(CLI::App& root, CommandOptions& s);
void add_focus(CLI::App& root, CommandOptions& s);
void add_shoot(CLI::App& root, CommandOptions& s);
void add_motionblur(CLI::App& root, CommandOptions& s);
void add_image(CLI::App& root, CommandOptions& s);
void add_records(CLI::App& root, CommandOptions& s);
void add_compare(CLI::App& root, CommandOptions& s);
void add_merge(CLI::App& root, CommandOptions& s);
void add_info(CLI::App& root, CommandOptions& s);
void add_view(CLI::App& root, CommandOptions& s);

/// Adds the option --share I/N, with which one of N machines makes only its part of the command's work.
/// `what` names what is divided among the machines, for example "rows of the picture".
void share_option(CLI::App& app, std::optional<Share>& to, const std::string& what);
/// Adds --frames, which runs the command for a range of frames, and --keep, which skips finished frames. If
/// `in_time` is true, the frames are instants of one scene file, and --fps is added.
void frame_options(CLI::App& app, FrameOptions& to, bool in_time);
/// Describes the parsed command for --dry-run, which predicts the command's time and memory from this
/// description.
[[nodiscard]] DryRun dry_run_of(CLI::App& app, const CommandOptions& options);

}  // namespace postlens
