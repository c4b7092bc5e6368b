#include "apps/cli.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <map>
#include <memory>

#include "apps/numbers.h"

#ifndef POSTLENS_VERSION
#define POSTLENS_VERSION "unknown"
#endif

namespace postlens {
namespace {

// Everything the parser fills in; it lives as long as the parsed command.
struct State {
    ParsedCommand common;
    TraceOptions trace;
    RenderOptions render;
    FocusOptions focus;
    RecordsOptions records;
    LensCommandOptions lens;
    CompareCommandOptions compare;
    std::string input, output;
};

// Options whose text is parsed by our own rules (inf, ranges, messages) rather than CLI11's.
CLI::Option* number(CLI::App& app, const std::string& name, std::optional<double>& to,
                    const std::string& help, const std::string& unit, bool infinite = false) {
    return app
        .add_option_function<std::string>(
            name, [&to, name, infinite](const std::string& text) { to = parse_number(name, text, infinite); },
            help)
        ->type_name(infinite ? unit + "|inf" : unit);
}

CLI::Option* number(CLI::App& app, const std::string& name, double& to, const std::string& help,
                    const std::string& unit, bool infinite = false) {
    return app
        .add_option_function<std::string>(
            name, [&to, name, infinite](const std::string& text) { to = parse_number(name, text, infinite); },
            fmt::format("{} [default: {:g}]", help, to))
        ->type_name(infinite ? unit + "|inf" : unit);
}

CLI::Option* whole(CLI::App& app, const std::string& name, int& to, const std::string& help,
                   const std::string& unit) {
    return app
        .add_option_function<std::string>(
            name, [&to, name](const std::string& text) { to = parse_whole(name, text); },
            fmt::format("{} [default: {}]", help, to))
        ->type_name(unit);
}

template <typename Enum>
CLI::Option* choice(CLI::App& app, const std::string& name, Enum& to, const std::string& help,
                    std::vector<std::pair<std::string, Enum>> values) {
    std::string words, default_word;
    for (const auto& [word, value] : values) {
        words += (words.empty() ? "" : "|") + word;
        if (value == to) default_word = word;
    }
    return app
        .add_option_function<std::string>(
            name,
            [&to, name, words, values = std::move(values)](const std::string& text) {
                for (const auto& [word, value] : values) {
                    if (word == text) {
                        to = value;
                        return;
                    }
                }
                fail(ExitCode::wrong_arguments, "{}: unknown (got {}; expected {})", name, text, words);
            },
            fmt::format("{} [default: {}]", help, default_word))
        ->type_name(words);
}

void common_options(CLI::App& app, State& s) {
    whole(app, "--threads", s.common.threads, "Threads to use, 0: all the machine has", "N");
    app.add_flag("--quiet", s.common.quiet, "No progress, no summary, no warnings; errors only");
    app.add_flag("--json", s.common.json, "The result as JSON on standard output");
}

void output_option(CLI::App& app, std::string& to, const std::string& help) {
    app.add_option("-o,--output", to, help)->required()->type_name("FILE");
}

// `source`: what names the values that are not given here.
void lens_options(CLI::App& app, LensOptions& to, const std::string& source = "the file's") {
    const std::string otherwise = " [default: " + source + "]";
    number(app, "--f-number", to.f_number, "Aperture number n; inf: pinhole" + otherwise, "N", true);
    number(app, "--focal-length", to.focal_length_mm, "Focal length F" + otherwise, "MM");
    auto* focus = number(app, "--focus", to.focus_m, "Focus distance s" + otherwise, "M", true);
    app.add_option_function<std::string>(
           "--focus-at", [&to](const std::string& text) { to.focus_at = parse_position("--focus-at", text); },
           "Focus on what is seen at this raster position")
        ->type_name("X,Y")
        ->excludes(focus);
    choice(app, "--framing", to.framing,
           "What F does to the view: keep: only the aperture changes; lens: film at F",
           {{"keep", Framing::keep}, {"lens", Framing::lens}});
    app.add_flag_function(
        "--breathing", [&to](std::int64_t) { to.framing = Framing::breathing; },
        "Film at V = F s / (s - F): the view breathes with the focus, as in the 1981 paper");
}

void scene_options(CLI::App& app, std::string& scene, double& metres_per_unit, CameraOverrides& camera,
                   std::string& camera_name) {
    app.add_option("scene", scene, "Scene: .toml (docs/scene_format.md) or .nff")
        ->required()
        ->type_name("SCENE");
    number(app, "--metres-per-unit", metres_per_unit, "Length of the scene's unit", "X");
    app.add_option_function<std::string>(
           "--size",
           [&camera](const std::string& text) {
               std::tie(camera.width, camera.height) = parse_size("--size", text);
           },
           "Raster, px [default: the camera's]")
        ->type_name("WxH");
    app.add_option("--camera", camera_name, "Camera by name [default: the scene's first]")->type_name("NAME");
    number(app, "--film-width", camera.film_width_mm, "Width of the film [default: the camera's]", "MM");
}

void tree_options(CLI::App& app, int& max_depth, double& min_contribution) {
    whole(app, "--max-depth", max_depth, "Nodes along a path, 1 to 17; the eye ray's is the first", "N");
    number(app, "--min-contribution", min_contribution,
           "Subtrees that cannot add this much radiance are not traced; 0 traces all", "C");
}

void add_trace(CLI::App& root, State& s) {
    CLI::App& app = *root.add_subcommand("trace", "Trace a scene through a pinhole into a sample file");
    TraceOptions& o = s.trace;
    TraceSettings& t = o.settings;
    scene_options(app, o.scene, o.metres_per_unit, t.camera, t.camera_name);
    output_option(app, o.output, "Sample file (OpenEXR)");
    number(app, "--time", t.time_s, "Instant of the trace [default: the scene's]", "S");
    number(app, "--focal-length", t.camera.focal_length_mm,
           "Film distance of the pinhole view [default: the camera's]", "MM");
    whole(app, "--subdivide", t.subdivision.levels,
          "Greatest depth of the recursive 2x2 subdivision of a pixel, 0 to 8", "LEVELS");
    number(app, "--threshold", t.subdivision.threshold,
           "Contrast (max-min)/(max+min+0.05) of its corners above which a cell is subdivided", "T");
    tree_options(app, t.whitted.max_depth, t.whitted.min_contribution);
    app.add_option_function<std::string>(
           "--overscan",
           [&t](const std::string& text) {
               t.overscan_auto = text == "auto";
               if (!t.overscan_auto) t.overscan_px = parse_whole("--overscan", text);
           },
           "Pixels traced beyond each side of the frame; auto: as wide as the lens asked for needs [default: "
           "0]")
        ->type_name("PX|auto");
    number(app, "--for-f-number", t.for_f_number, "Size the file for apertures down to this f-number", "N");
    number(app, "--for-focus", t.for_focus_m, "Size the file for this focus distance", "M", true);
    choice(app, "--compression", t.compression, "Compression of the records",
           {{"none", RecordCompression::none},
            {"rle", RecordCompression::rle},
            {"zips", RecordCompression::zips}});
    common_options(app, s);
    app.callback([&s] {
        s.common.run = [&s] {
            s.trace.settings.quiet = s.common.quiet;
            return run_trace(s.trace);
        };
    });
}

void shutter_options(CLI::App& app, std::optional<TimeSpan>& shutter, std::string& curve) {
    app.add_option_function<std::string>(
           "--shutter",
           [&shutter](const std::string& text) {
               const auto [open, close] = parse_span("--shutter", text);
               shutter = TimeSpan{open, close};
           },
           "When the shutter opens and closes, on the scene's clock [default: open for an instant]")
        ->type_name("OPEN:CLOSE");
    app.add_option(
           "--shutter-curve", curve,
           "Transmission while it is open: box, triangle, or a text file of lines \"time transmission\" "
           "[default: box]")
        ->type_name("box|triangle|FILE");
}

void add_render(CLI::App& root, State& s) {
    CLI::App& app =
        *root.add_subcommand("render", "The picture by distributed rays over lens and time: the reference");
    RenderOptions& o = s.render;
    RenderSettings& r = o.settings;
    scene_options(app, o.scene, o.metres_per_unit, r.camera, r.camera_name);
    output_option(app, o.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    whole(app, "--spp", r.spp, "Samples per pixel, 1 to 1048576", "N")->required();
    lens_options(app, o.lens, "the camera's");
    number(app, "--time", r.time_s, "Instant without a shutter [default: the scene's]", "S");
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
    common_options(app, s);
    app.callback([&s] {
        s.common.run = [&s] {
            s.render.settings.quiet = s.common.quiet;
            return run_render(s.render);
        };
    });
}

void add_image(CLI::App& root, State& s) {
    CLI::App& app = *root.add_subcommand("image", "The pinhole picture, from the records alone");
    app.add_option("frame", s.input, "Sample file")->required()->type_name("FRAME");
    output_option(app, s.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    common_options(app, s);
    app.callback([&s] { s.common.run = [&s] { return run_image(s.input, s.output); }; });
}

void add_records(CLI::App& root, State& s) {
    CLI::App& app =
        *root.add_subcommand("records", "The shading trees at a pixel: every node, its z', W and CoC");
    RecordsOptions& o = s.records;
    app.add_option("frame", o.input, "Sample file")->required()->type_name("FRAME");
    app.add_option_function<std::string>(
           "--at", [&o](const std::string& text) { o.at = parse_position("--at", text); },
           "Raster position, px")
        ->required()
        ->type_name("X,Y");
    lens_options(app, o.lens);
    common_options(app, s);
    app.callback([&s] { s.common.run = [&s] { return run_records(s.records); }; });
}

void add_focus(CLI::App& root, State& s) {
    CLI::App& app = *root.add_subcommand("focus", "The picture through a lens, from the records alone");
    FocusOptions& o = s.focus;
    app.add_option("frame", o.input, "Sample file")->required()->type_name("FRAME");
    output_option(app, o.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    lens_options(app, o.lens);
    choice(app, "--method", o.method, "How",
           {{"scatter", FocusMethod::scatter}, {"pinhole", FocusMethod::pinhole}});
    app.add_option_function<std::string>(
           "--depths", [&o](const std::string& text) { o.depths = parse_whole("--depths", text); },
           "Number K of impulse responses, 2 or more [default: CoC right to half a pixel]")
        ->type_name("K");
    choice(app, "--spacing", o.spacing, "Spacing of the K depths: equal steps in z' or in 1/z'",
           {{"linear", DepthSpacing::linear}, {"inverse", DepthSpacing::inverse}});
    choice(app, "--depth-model", o.depth_model,
           "Depth of what mirrors and glass show: W, the path's length, or the first hit",
           {{"W", DepthModel::ray_differentials},
            {"path", DepthModel::path},
            {"first-hit", DepthModel::first_hit}});
    app.add_flag("--strict", o.strict, "Exit with 6 where the file does not suffice for the request");
    common_options(app, s);
    app.callback([&s] { s.common.run = [&s] { return run_focus(s.focus); }; });
}

void lens_numbers(CLI::App& app, LensCommandOptions& o) {
    number(app, "--focal-length", o.focal_length_mm, "Focal length F, more than 0", "MM")->required();
    number(app, "--f-number", o.f_number, "Aperture number n, more than 0; inf: pinhole", "N", true)
        ->required();
    number(app, "--focus", o.focus_m, "Focus distance s, more than F", "M", true)->required();
    number(app, "--coc-limit", o.coc_limit_mm, "Widest circle of confusion that counts as sharp", "MM");
    number(app, "--pixel-pitch", o.pixel_pitch_um,
           "Pixel pitch on the film; the default is 36 mm over 1920 px", "UM");
}

void add_lens(CLI::App& root, State& s) {
    CLI::App& lens = *root.add_subcommand("lens", "Optics without a scene");
    lens.require_subcommand(1);
    CLI::App& coc =
        *lens.add_subcommand("coc", "Circle of confusion of what lies at a depth, on a film at V");
    lens_numbers(coc, s.lens);
    number(coc, "--depth", s.lens.depth_m, "Depth z' of the object, more than 0", "M", true)->required();
    common_options(coc, s);
    coc.callback([&s] { s.common.run = [&s] { return run_lens_coc(s.lens); }; });
    CLI::App& dof = *lens.add_subcommand("dof", "Depth of field: between which depths the picture is sharp");
    lens_numbers(dof, s.lens);
    common_options(dof, s);
    dof.callback([&s] { s.common.run = [&s] { return run_lens_dof(s.lens); }; });
}

void add_compare(CLI::App& root, State& s) {
    CLI::App& app = *root.add_subcommand("compare", "How far a picture is from its reference, in figures");
    CompareCommandOptions& o = s.compare;
    app.add_option("image", o.image, "Picture to judge, or a sample file: its pinhole picture")
        ->required()
        ->type_name("IMAGE");
    app.add_option("reference", o.reference, "Picture to hold it against, of the same size")
        ->required()
        ->type_name("REFERENCE");
    app.add_option("--noise", o.noise,
                   "An independent render of the reference (another seed, as many rays): tells how good the "
                   "reference is and the error above its noise")
        ->type_name("IMAGE");
    app.add_option("--pinhole", o.pinhole,
                   "The pinhole picture: figures also for the affected pixels, where it differs from the "
                   "reference by more than 1/255 (sRGB)")
        ->type_name("IMAGE");
    app.add_option("--map", o.map, "Write where they differ, as colours with a legend")->type_name("PNG");
    app.add_option("--side-by-side", o.side_by_side, "Write both pictures, the map and the figures")
        ->type_name("PNG");
    number(app, "--fail-psnr", o.limits.least_psnr_db, "Exit with 1 where the PSNR is less, 0 or more", "DB");
    number(app, "--fail-relmse", o.limits.greatest_relmse, "Exit with 1 where relMSE is more, 0 or more",
           "X");
    number(app, "--fail-flip", o.limits.greatest_flip, "Exit with 1 where FLIP is more, 0 to 1", "X");
    number(app, "--flip-white", o.flip_white,
           "Luminance that HDR-FLIP takes for white, 0.18 being grey, more than 0 [default: the reference's "
           "maximum and median]",
           "Y");
    common_options(app, s);
    app.callback([&s] { s.common.run = [&s] { return run_compare(s.compare); }; });
}

void add_info(CLI::App& root, State& s) {
    CLI::App& app = *root.add_subcommand("info", "What is in a file: scene, sample file or image");
    app.add_option("file", s.input, "Any of them")->required()->type_name("FILE");
    common_options(app, s);
    app.callback([&s] { s.common.run = [&s] { return run_info(s.input); }; });
}

// CLI11 says only that one is required.
void check_subcommand(const CLI::App& app, const std::vector<std::string>& arguments) {
    if (arguments.empty() || arguments[0].starts_with('-')) return;
    std::string known;
    for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (sub->get_name() == arguments[0]) return;
        known += (known.empty() ? "" : ", ") + sub->get_name();
    }
    fail(ExitCode::wrong_arguments, "unknown subcommand (got {}; expected one of {})", arguments[0], known);
}

}  // namespace

ParsedCommand parse_command_line(std::vector<std::string> arguments) {
    const auto state = std::make_shared<State>();
    CLI::App app("postlens: render once through a pinhole, apply the lens afterwards", "postlens");
    app.set_version_flag("--version", "postlens " POSTLENS_VERSION);
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    add_trace(app, *state);
    add_image(app, *state);
    add_records(app, *state);
    add_render(app, *state);
    add_focus(app, *state);
    add_lens(app, *state);
    add_compare(app, *state);
    add_info(app, *state);
    check_subcommand(app, arguments);
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
    try {
        app.parse(arguments);
    } catch (const CLI::Success& e) {
        std::ostringstream text, errors;
        app.exit(e, text, errors);
        ParsedCommand help;
        help.text = text.str();
        return help;
    } catch (const CLI::ParseError& e) {
        std::string what = e.what();
        std::replace(what.begin(), what.end(), '\n', ' ');
        fail(ExitCode::wrong_arguments, "{} (see postlens --help)", what);
    }
    if (state->common.threads < 0 || state->common.threads > 4096) {
        fail(ExitCode::wrong_arguments, "--threads: out of range (got {}; expected 0 to 4096)",
             state->common.threads);
    }
    ParsedCommand out = state->common;
    // The call refers into the state, which must outlive it.
    out.run = [state] { return state->common.run(); };
    return out;
}

}  // namespace postlens
