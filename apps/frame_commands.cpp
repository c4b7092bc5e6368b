// What changes from frame to frame in each command.
#include <cmath>

#include "apps/frame_range.h"
#include "apps/numbers.h"

namespace postlens {
namespace {

constexpr double default_fps = 24;

/// Frame n is at n / fps on the scene's clock; --time moves all frames.
double time_of(const FrameOptions& options, int frame, const std::optional<double>& time_s) {
    return frame / options.fps.value_or(default_fps) + time_s.value_or(0);
}

void check_fps(const FrameOptions& options) {
    if (options.fps) in_range("--fps", *options.fps, 0, false, "more than 0");
}

std::optional<TimeSpan> moved(std::optional<TimeSpan> span, double by_s) {
    if (span) span = TimeSpan{span->open_s + by_s, span->close_s + by_s};
    return span;
}

}  // namespace

CommandResult run_frames(const FrameOptions& frames, const TraceOptions& options) {
    const FrameFiles names{options.scene, options.output, {}};
    if (!frames.frames) refuse_frames(frames, names);
    if (!frames.frames) return run_trace(options);
    check_fps(frames);
    return run_frame_range(frames, names, true, [&](const FrameFiles& files, int frame) {
        TraceOptions o = options;
        o.scene = files.input;
        o.output = files.output;
        const double time_s = time_of(frames, frame, options.settings.time_s);
        o.settings.time_s = time_s;
        o.settings.for_shutter = moved(options.settings.for_shutter, time_s);
        CommandResult out = run_trace(o);
        out.json["time_s"] = time_s;
        return out;
    });
}

CommandResult run_frames(const FrameOptions& frames, const RenderOptions& options) {
    const FrameFiles names{options.scene, options.output, {}, options.settings.halves};
    if (!frames.frames) refuse_frames(frames, names);
    if (!frames.frames) return run_render(options);
    check_fps(frames);
    return run_frame_range(frames, names, true, [&](const FrameFiles& files, int frame) {
        RenderOptions o = options;
        o.scene = files.input;
        o.output = files.output;
        const double time_s = time_of(frames, frame, options.settings.time_s);
        o.settings.time_s = time_s;
        o.settings.shutter = moved(options.settings.shutter, time_s);
        CommandResult out = run_render(o);
        out.json["time_s"] = time_s;
        return out;
    });
}

CommandResult run_frames(const FrameOptions& frames, const ImageOptions& options) {
    const FrameFiles names{options.input, options.output, {}};
    if (!frames.frames) refuse_frames(frames, names);
    if (!frames.frames) return run_image(options);
    return run_frame_range(frames, names, false, [&](const FrameFiles& files, int) {
        ImageOptions o = options;
        o.input = files.input;
        o.output = files.output;
        return run_image(o);
    });
}

CommandResult run_frames(const FrameOptions& frames, const FocusOptions& options) {
    const FrameFiles names{options.input, options.output, options.retrace.explain};
    if (!frames.frames) refuse_frames(frames, names);
    if (!frames.frames) return run_focus(options);
    return run_frame_range(frames, names, false, [&](const FrameFiles& files, int) {
        FocusOptions o = options;
        o.input = files.input;
        o.output = files.output;
        o.retrace.explain = files.explain;
        return run_focus(o);
    });
}

CommandResult run_frames(const FrameOptions& frames, const MotionBlurOptions& options) {
    const FrameFiles names{options.input, options.output, {}};
    if (!frames.frames) refuse_frames(frames, names);
    if (!frames.frames) return run_motionblur(options);
    return run_frame_range(frames, names, false, [&](const FrameFiles& files, int) {
        MotionBlurOptions o = options;
        o.input = files.input;
        o.output = files.output;
        o.shutter_from_frame = true;
        return run_motionblur(o);
    });
}

CommandResult run_frames(const FrameOptions& frames, const ShootOptions& options) {
    const FrameFiles names{options.focus.input, options.focus.output, options.focus.retrace.explain};
    if (!frames.frames) refuse_frames(frames, names);
    if (!frames.frames) return run_shoot(options);
    return run_frame_range(frames, names, false, [&](const FrameFiles& files, int) {
        ShootOptions o = options;
        o.focus.input = files.input;
        o.focus.output = files.output;
        o.focus.retrace.explain = files.explain;
        o.shutter_from_frame = true;
        return run_shoot(o);
    });
}

}  // namespace postlens
