// Options that divide the work of a command between frames or machines, or that predict its cost.
#include <limits>

#include "apps/numbers.h"
#include "apps/options/command_options.h"
#include "sweep/picture_maker.h"

namespace postlens {

void share_option(CLI::App& app, std::optional<Share>& to, const std::string& what) {
    app.add_option_function<std::string>(
           "--share", [&to](const std::string& text) { to = parse_share("--share", text); },
           "Only the I-th of N parts of the work, from 0: " + what + " (docs/farm.md)")
        ->type_name("I/N");
}

void frame_options(CLI::App& app, FrameOptions& to, bool in_time) {
    app.add_option_function<std::string>(
           "--frames", [&to](const std::string& text) { to.frames = parse_frames("--frames", text); },
           "Do so for each of these frames; file names hold the number as f.%04d.exr or f.####.exr "
           "(docs/frames.md)")
        ->type_name("1-48[x2],...");
    app.add_flag("--keep", to.keep,
                 "With --frames: leave out those whose output is there, whole, and made by the same options "
                 "from the same "
                 "inputs");
    if (in_time)
        number(app, "--fps", to.fps, "With --frames: frame n is at n / FPS s [default: 24]", "FPS", above_0);
}

DryRun dry_run_of(CLI::App& app, const CommandOptions& options) {
    CLI::App& sub = *app.get_subcommands().front();
    DryRun out{.words = words_of(app),
               .output = sub.get_option("--output")->results().front(),
               .shares = options.share.value_or(Share()).count,
               .by_samples = options.render.share_by_samples,
               .frames = options.frames.frames};
    out.output_of = [name = FrameName(out.output, true)](int frame) { return name.of(frame); };
    const auto by_views = [&](FocusMethod method, int views) {
        if (method != FocusMethod::lightfield && method != FocusMethod::hybrid) return;
        out.amount_option = "--views";
        out.amount = views;
    };
    if (sub.get_name() == "render") {
        out.amount_option = "--spp";
        out.amount = options.render.settings.spp;
    } else if (sub.get_name() == "focus") {
        by_views(options.focus.method, options.focus.views.value_or(default_lens_views));
    } else if (sub.get_name() == "shoot") {
        by_views(options.shoot.focus.method, options.shoot.focus.views.value_or(default_shutter_views));
    } else if (sub.get_name() == "motionblur" &&
               options.motionblur.settings.method == MotionMethod::lightfield &&
               options.motionblur.settings.views) {
        out.amount_option = "--views";
        out.amount = *options.motionblur.settings.views;
    }
    return out;
}

}  // namespace postlens
