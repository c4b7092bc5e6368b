// The options of `trace` and `render`, which read scenes.
#include <limits>

#include "apps/numbers.h"
#include "apps/options/command_options.h"

namespace postlens {
namespace {

void shutter_trace_options(CLI::App& app, TraceSettings& t) {
    instants(app, "--for-shutter", t.for_shutter,
             "Make the file suffice for a shutter open between these instants of the scene's clock, s; OPEN "
             "not "
             "after CLOSE");
    app.add_option_function<std::string>(
           "--hidden-layers",
           [&t](const std::string& text) {
               t.hidden_auto = text == "auto";
               t.hidden_layers.reset();
               if (!t.hidden_auto) t.hidden_layers = parse_whole("--hidden-layers", text);
           },
           "Surfaces recorded behind each visible one, 0 to 16; auto: up to 4 that may come to light during "
           "--for-shutter, and up to 3 that a lens of --for-f-number sees past the edges of others, in "
           "mirrors and glass as well [default: auto with one of these, else 0]")
        ->type_name("N|auto");
    app.add_option_function<std::string>(
           "--keys",
           [&t](const std::string& text) {
               t.keys.reset();
               if (text != "auto") t.keys = parse_whole("--keys", text);
           },
           "Instants recorded, 1 to 64, evenly spread over --for-shutter, besides the frame's own; 1: that "
           "alone; auto: where something turns to the camera by more than 15 degrees, one more for every 15 "
           "(30 with --for-rays), for pans and for objects that pass through the frame, and enough for "
           "43 dB where light changes (31 with --for-rays) [default: 1]")
        ->type_name("K|auto");
}

/// Throws if an option states a number (`stated`) that --plan chooses.
void refuse_planned(const CLI::App& app, const std::string& option, bool stated) {
    if (app.count(option) == 0 || !stated) return;
    fail(ExitCode::wrong_arguments, "{}: not with --plan, which chooses it (got {}; expected one of them)",
         option, app.get_option(option)->results().front());
}

}  // namespace

void add_trace(CLI::App& root, CommandOptions& s) {
    CLI::App& app = *root.add_subcommand("trace", "Trace a scene through a pinhole into a sample file");
    TraceOptions& o = s.trace;
    TraceSettings& t = o.settings;
    scene_options(app, o.scene, o.units, t.camera, t.camera_name);
    output_option(app, o.output, "Sample file (OpenEXR)");
    exposure_option(app, o.exposure, "0");
    frame_options(app, s.frames, true);
    dry_run_option(app, s.common);
    share_option(app, s.share, "rows of the records, or every N-th of --frames");
    number(app, "--time", t.time_s, "Instant of the trace on the scene's clock [default: the scene's]", "S",
           any_value);
    app.add_option_function<std::string>("--focal-length",
                                         [](const std::string& text) {
                                             fail(ExitCode::wrong_arguments,
                                                  "--focal-length: a trace has a pinhole (got {}; expected "
                                                  "--film-distance for the view, and --focal-length with "
                                                  "focus or render for the lens)",
                                                  text);
                                         })
        ->group("");
    t.subdivide_for_lens = true;
    app.add_option_function<std::string>(
           "--subdivide",
           [&t](const std::string& text) {
               t.subdivide_for_lens = false;
               t.subdivision.levels = parse_whole("--subdivide", text);
           },
           "Greatest depth of the recursive 2x2 subdivision of a pixel, 0 to 8 [default: 2; with "
           "--for-f-number 3 where objects end, as records no finer than that bound how sharp a lens is; "
           "with --for-rays 1]")
        ->type_name("LEVELS");
    number(app, "--threshold", t.subdivision.threshold,
           "Contrast (max-min)/(max+min+0.05) of its corners above which a cell is subdivided", "T", from_0);
    tree_options(app, t.whitted.max_depth, t.whitted.min_contribution);
    app.add_option_function<std::string>(
           "--overscan",
           [&t](const std::string& text) {
               t.overscan_auto = text == "auto";
               if (!t.overscan_auto) t.overscan_px = parse_whole("--overscan", text);
           },
           "Pixels traced beyond each side of the frame; auto: as wide as the lens and the shutter asked for "
           "need [default: 0]")
        ->type_name("PX|auto");
    shutter_trace_options(app, t);
    number(app, "--for-f-number", t.for_f_number,
           "Size the file for apertures down to this f-number: see --hidden-layers, --subdivide "
           "and "
           "--overscan",
           "N", above_0);
    number(app, "--for-focus", t.for_focus_m, "Size --overscan auto and --plan for this focus distance", "M",
           above_0, true);
    app.add_flag(
        "--for-rays", o.for_rays,
        "Size the file for images that are made with --scene: one level of subdivision, as rays replace "
        "what coarse records do not determine; --subdivide overrides this");
    app.add_flag(
        "--plan", o.plan,
        "Choose subdivision, hidden layers, overscan and keys for the lens and shutter named and for "
        "--target-db, from a look at a quarter of the size; says what size and time to expect");
    number(
        app, "--target-db", o.target_db,
        "With --plan: PSNR that pictures from the file are to reach; no effect on the levels with --for-rays",
        "DB", target_decibels);
    app.add_flag("--force", o.force,
                 "Trace even where the file will not fit on its disk, as a look at a few rows tells");
    choice(app, "--compression", t.compression, "Compression of the records",
           {{"none", RecordCompression::none},
            {"rle", RecordCompression::rle},
            {"zips", RecordCompression::zips}});
    common_options(app, s.common);
    app.callback([&app, &s] {
        go_with(app, {"--for-focus"}, "--for-f-number");
        go_with(app, {"--target-db"}, "--plan");
        if (s.trace.plan) {
            refuse_planned(app, "--subdivide", true);
            refuse_planned(app, "--overscan", !s.trace.settings.overscan_auto);
            refuse_planned(app, "--keys", s.trace.settings.keys.has_value());
        }
        s.common.run = [&s] { return run_frames(s.asked_frames(), s.trace); };
    });
}

void add_render(CLI::App& root, CommandOptions& s) {
    CLI::App& app =
        *root.add_subcommand("render", "The picture by distributed rays over lens and time: the reference");
    RenderOptions& o = s.render;
    RenderSettings& r = o.settings;
    scene_options(app, o.scene, o.units, r.camera, r.camera_name);
    output_option(app, o.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    crop_option(app, r.crop);
    exposure_option(app, o.exposure, "0");
    frame_options(app, s.frames, true);
    dry_run_option(app, s.common);
    share_option(app, s.share, "rows of the picture, or every N-th of --frames");
    choice(app, "--share-by", s.render.share_by_samples,
           "What --share divides: rows of the picture, or the samples of every pixel",
           {{"rows", false}, {"samples", true}});
    required_whole(app, "--spp", r.spp, "Samples per pixel", "N", {.low = 1, .high = 1 << 20});
    lens_options(app, o.lens, "the camera's");
    impulse_options(app, o.impulse);
    number(app, "--time", r.time_s, "Instant without a shutter [default: the scene's]", "S", any_value);
    shutter_options(app, r.shutter, o.curve);
    choice(app, "--sampler", r.sampler, "How samples spread over pixel, lens, time, lights and gloss",
           {{"grid", SamplerKind::grid},
            {"jittered", SamplerKind::jittered},
            {"random", SamplerKind::random},
            {"poisson", SamplerKind::poisson},
            {"sobol", SamplerKind::sobol}});
    app.add_option_function<std::string>(
           "--seed", [&r](const std::string& text) { r.seed = parse_seed("--seed", text); },
           "Of all random numbers; the same seed gives the same bits [default: 0]")
        ->type_name("N");
    app.add_flag(
        "--halves", r.halves,
        "Also write two independent halves of the samples, NAME.a and NAME.b, to measure the noise by");
    app.add_flag("--resume", r.resume, "Go on from NAME.partial.exr, which an interrupted run has left");
    tree_options(app, r.tracing.max_depth, r.tracing.min_contribution);
    common_options(app, s.common);
    app.callback([&app, &s] {
        go_with(app, {"--shutter-curve"}, "--shutter");
        go_with(app, {"--share-by"}, "--share");
        if (app.count("--time") > 0 && app.count("--shutter") > 0 && app.count("--frames") == 0) {
            fail(ExitCode::wrong_arguments,
                 "--time: not with --shutter, which states the instants (got both; expected one of them, or "
                 "--frames)");
        }
        s.common.run = [&s] { return run_frames(s.asked_frames(), s.render); };
    });
}

}  // namespace postlens
