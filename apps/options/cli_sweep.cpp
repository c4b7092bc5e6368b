#include <memory>

#include "apps/commands/dry_run.h"
#include "apps/commands/sweep_command.h"
#include "apps/numbers.h"
#include "apps/options/cli_options.h"

namespace postlens {
namespace {

void axis(CLI::App& app, const std::string& name, std::optional<std::string>& to, const std::string& help,
          const std::string& form) {
    app.add_option(name, to, help)->type_name(form);
}

void axis_options(CLI::App& app, SweepOptions& o) {
    axis(app, "--f-number", o.f_number,
         "f-numbers; a range FROM:TO:STEP in stops, e.g. 1.4:16:1/2; inf: pinhole [default: the file's]",
         "LIST");
    axis(app, "--focal-length", o.focal_length,
         "Focal lengths, mm; a range FROM:TO:COUNT in equal factors [default: the file's]", "LIST");
    axis(app, "--focus", o.focus,
         "Focus distances, m, or inf; a range FROM:TO:COUNT evenly in 1/s, either way [default: the file's]",
         "LIST");
    axis(
        app, "--shutter", o.shutter,
        "When the shutter opens and closes, s on the scene's clock: lens and shutter at once, as shoot; with "
        "f/inf as motionblur [default: no shutter]",
        "OPEN:CLOSE,...");
    axis(app, "--impulse", o.impulse, "What a point out of focus becomes, as for focus [default: disc]",
         "KIND,...");
    number(app, "--squeeze", o.modifiers.squeeze, "Of every impulse response, as for focus", "X",
           {.low = 0.1, .high = 10});
    number(app, "--cats-eye", o.modifiers.cats_eye, "Of every impulse response, as for focus", "X",
           {.low = 0, .high = 1.5});
    number(app, "--spherical", o.modifiers.spherical, "Of every impulse response, as for focus", "X",
           {.low = -10, .high = 10});
}

void method_options(CLI::App& app, SweepOptions& o) {
    PictureSettings& p = o.settings.picture;
    app.add_option_function<std::string>(
           "--method",
           [&p](const std::string& text) {
               constexpr const char* words = "scatter|layers|lightfield|hybrid|auto|pinhole";
               for (const FocusMethod m :
                    {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield, FocusMethod::hybrid,
                     FocusMethod::automatic, FocusMethod::pinhole}) {
                   if (text == method_name(m)) {
                       p.method = m;
                       return;
                   }
               }
               fail(ExitCode::wrong_arguments, "--method: unknown (got {}; expected {})", text, words);
           },
           "How, as for focus [default: as focus; with --shutter lightfield]")
        ->type_name("scatter|layers|lightfield|hybrid|auto|pinhole");
    number(app, "--target-db", p.target_db,
           fmt::format("With --method auto: PSNR wanted of the picture [default: {:g} with --scene or "
                       "--shutter, else the usual method]",
                       default_target_db),
           "DB", target_decibels);
    whole(app, "--depths", p.depths,
          "Number K of impulse responses [default: as many as keep CoCs right to half a pixel]", "K",
          depth_counts);
    whole(app, "--views", p.views,
          "Points of the lens that lightfield and hybrid look from [default: 64; with --shutter "
          "128]",
          "M", lens_view_counts);
    choice(app, "--spacing", p.spacing, "Spacing of the K depths: equal steps in z' or in 1/z'",
           {{"linear", DepthSpacing::linear}, {"inverse", DepthSpacing::inverse}});
    choice(app, "--depth-model", p.depth_model,
           "Depth of what mirrors and glass show: W, the path's length, or the first hit",
           {{"W", DepthModel::ray_differentials},
            {"path", DepthModel::path},
            {"first-hit", DepthModel::first_hit}});
    choice(app, "--framing", p.framing,
           "What F does to the view: keep: only the aperture changes; lens: film at F",
           {{"keep", Framing::keep}, {"lens", Framing::lens}});
    app.add_flag_function(
        "--breathing", [&p](std::int64_t) { p.framing = Framing::breathing; },
        "Film at V = F s / (s - F): the view breathes with the focus, as in the 1981 paper");
    reads_of_curve(
        app.add_option("--shutter-curve", o.curve,
                       "Transmission while it is open: box, triangle, or a text file of lines \"time "
                       "transmission\" [default: box]"))
        ->type_name("box|triangle|FILE");
    reads(app.add_option("--paths", o.paths,
                         "Paths of objects, in place of what the file says (docs/motion_paths.md)"))
        ->type_name("PATHS.toml");
    reads(
        app.add_option("--scene", o.retrace.scene,
                       "The scene that the frame was traced from: rays in it replace what the records do not "
                       "determine, as for focus and shoot [default: no rays]"))
        ->type_name("SCENE");
    number(app, "--metres-per-unit", o.retrace.metres_per_unit,
           "With --scene: size of its unit, m [default: as the sample file was traced]", "X", units_m);
    lumens_option(app, o.retrace.lumens_per_watt, "With --scene: ");
}

void folder_options(CLI::App& app, SweepOptions& o) {
    SweepSettings& s = o.settings;
    app.add_option("--format", o.format, "Of the pictures: exr, png, tif or jpg [default: exr]")
        ->type_name("exr|png|tif|jpg");
    app.add_option("--frames", s.frames,
                   "Number the pictures from 1 in their order, e.g. pull.%04d.png for a focus pull [default: "
                   "named by their settings]")
        ->type_name("NAME");
    app.add_option_function<std::vector<std::string>>(
           "--at",
           [&s](const std::vector<std::string>& texts) {
               for (const std::string& text : texts) {
                   const auto [x, y] = parse_position("--at", text);
                   s.at.emplace_back(x, y);
               }
           },
           "Where the table tells the CoC, px of the trace; may be repeated [default: 3 x 3 points]")
        ->type_name("X,Y");
    number(app, "--coc-limit", s.coc_limit_px, "A pixel whose CoC is narrower is in focus", "PX", above_0);
    app.add_flag("--resume", s.resume,
                 "Keep the pictures of an earlier run in DIR that were made with the same settings from the "
                 "same file");
    app.add_option_function<std::string>(
           "--share", [&s](const std::string& text) { s.share = parse_share("--share", text); },
           "Only every N-th picture, from the I-th, for `merge` (docs/farm.md)")
        ->type_name("I/N");
    predict_option(app, s.picture.predict);
    strict_option(app, o.strict);
    app.add_flag_function(
        "--salvage", [&s](std::int64_t) { s.damage = Damage::salvage; },
        "Read the intact rows of a damaged or truncated sample file, as for focus");
}

}  // namespace

void add_sweep(CLI::App& root, ParsedCommand& common) {
    CLI::App& app = *root.add_subcommand(
        "sweep", "Many pictures of one sample file: every combination of lenses and shutters");
    const auto o = std::make_shared<SweepOptions>();
    reads(app.add_option("frame", o->input, "Sample file"))->required()->type_name("FRAME");
    writes(app.add_option(
               "-o,--output", o->output,
               "Folder for the pictures, sweep.csv, sweep.json and contact.png; made if it is not there"))
        ->required()
        ->type_name("DIR");
    axis_options(app, *o);
    method_options(app, *o);
    folder_options(app, *o);
    exposure_option(app, o->exposure, "the sample file's");
    dry_run_option(app, common);
    common_options(app, common);
    app.callback([o, &app, &common] {
        go_with(app, {"--shutter-curve", "--paths"}, "--shutter");
        o->settings.join = common.join;
        // CLI11's option objects no longer exist when the command runs, so the lambda copies all options.
        common.run = [o, dry = common.dry_run, asked = asked_for(app), words = words_of(app)] {
            SweepSettings& s = o->settings;
            if (dry) {
                return dry_run({.words = words,
                                .output = o->output,
                                .shares = s.share.value_or(Share()).count,
                                .pictures = static_cast<int>(pictures_of(*o))});
            }
            if (s.share) s.part = mark_of_items(*s.share, asked, words);
            return run_sweep(*o);
        };
    });
}

}  // namespace postlens
