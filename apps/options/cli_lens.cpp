#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "apps/lens/lens_command.h"
#include "apps/lens/lens_fit_limits_command.h"
#include "apps/lens/lens_psf_command.h"
#include "apps/numbers.h"
#include "apps/options/cli_options.h"

namespace postlens {
namespace {

constexpr OptionRange wavelengths_nm{.low = shortest_wavelength_nm, .high = longest_wavelength_nm};

/// One of the alternative tasks of a command such as `lens fit`, and the options that this task uses.
struct Task {
    std::string_view name;
    std::vector<std::string_view> uses;
};

/// Throws if an option is given that has no effect on this task.
void refuse_unused(const CLI::App& app, const Task& task, std::span<const Task> all) {
    const auto uses = [](const Task& t, const std::string& option) {
        return std::find(t.uses.begin(), t.uses.end(), option) != t.uses.end();
    };
    for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return o->count() > 0; })) {
        const std::string name = option->get_name();
        if (uses(task, name)) continue;
        for (const Task& other : all) {
            if (!uses(other, name)) continue;
            fail(ExitCode::wrong_arguments, "{}: not with {} (got {}; expected none, or {})", name, task.name,
                 option->results().front(), other.name);
        }
    }
}

const std::array<Task, 2> psf_tasks{
    {{"--crossover", {"--focal-length", "--focus", "--depth", "--wavelength", "--pixel-pitch", "--profile"}},
     {"a picture OUT.exr",
      {"output", "--focal-length", "--f-number", "--focus", "--depth", "--wavelength", "--pixel-pitch",
       "--size", "--impulse", "--squeeze", "--spherical", "--profile"}}}};

const std::array<Task, 4> fit_tasks{
    {{"a prescription",
      {"--f-number", "--focus", "--wavelength", "--focus-by", "--move", "--depths", "--field",
       "--tolerance-px", "--pixel-pitch", "--samples"}},
     {"--pairs", {"--focal-length", "--f-number"}},
     {"--sharp", {"--coc-limit", "--sensor", "--focal-length", "--f-number", "--wavelength"}},
     {"--picture", {"--frame", "--focal-length", "--impulse", "--squeeze", "--cats-eye", "--spherical"}}}};

void lens_numbers(CLI::App& app, LensCommandOptions& o) {
    required_number(app, "--focal-length", o.focal_length_mm, "Focal length F", "MM", above_0);
    required_number(app, "--f-number", o.f_number, "Aperture number n; inf: pinhole", "N", f_numbers, true);
    required_number(app, "--focus", o.focus_m, "Focus distance s, beyond F", "M", above_0, true);
    number(app, "--coc-limit", o.coc_limit_mm, "Widest circle of confusion that counts as sharp", "MM",
           above_0);
    number(app, "--pixel-pitch", o.pixel_pitch_um,
           "Pixel pitch on the film; the default is 36 mm over 1920 px", "UM", above_0);
}

void add_coc(CLI::App& lens, ParsedCommand& common) {
    CLI::App& app =
        *lens.add_subcommand("coc", "Circle of confusion of what lies at a depth, on a film at V");
    const auto o = std::make_shared<LensCommandOptions>();
    lens_numbers(app, *o);
    number(app, "--depth", o->depth_m, "Depth z' of the object", "M", above_0, true)->required();
    common_options(app, common);
    app.callback([&common, o] { common.run = [o] { return run_lens_coc(*o); }; });
}

void add_dof(CLI::App& lens, ParsedCommand& common) {
    CLI::App& app = *lens.add_subcommand("dof", "Depth of field: between which depths the picture is sharp");
    const auto o = std::make_shared<LensCommandOptions>();
    lens_numbers(app, *o);
    common_options(app, common);
    app.callback([&common, o] { common.run = [o] { return run_lens_dof(*o); }; });
}

void add_psf(CLI::App& lens, ParsedCommand& common) {
    CLI::App& app = *lens.add_subcommand(
        "psf", "What one point becomes on a film at V: its impulse response, energy per pixel, as OpenEXR");
    const auto o = std::make_shared<LensPsfOptions>();
    writes(app.add_option("output", o->output, "Picture of one channel, Y"))->type_name("OUT.exr");
    number(app, "--focal-length", o->focal_length_mm, "Focal length F", "MM", above_0);
    number(app, "--f-number", o->f_number, "Aperture number n; inf: pinhole", "N", f_numbers, true);
    number(app, "--focus", o->focus_m, "Focus distance s, beyond F", "M", above_0, true);
    number(app, "--depth", o->depth_m, "Depth z' of the point", "M", above_0, true);
    number(app, "--wavelength", o->wavelength_nm, "Wavelength [default: 550]", "NM", wavelengths_nm);
    number(app, "--pixel-pitch", o->pixel_pitch_um, "Pixel pitch on the film", "UM", above_0);
    whole(app, "--size", o->size_px, "Width and height; 0: what holds 99% of the energy, at most 1025", "PX",
          {.low = 0, .high = 16384});
    impulse_options(app, o->impulse, true);
    writes(app.add_option(
               "--profile", o->profile,
               "Also write a table: radius, v, intensity, encircled energy; with --crossover: f-number, Airy "
               "disc, circle of confusion, pixel"))
        ->type_name("FILE.csv");
    app.add_flag("--crossover", o->crossover,
                 "Say instead from which f-number on diffraction is wider than defocus and than a pixel");
    common_options(app, common);
    app.callback([&app, &common, o] {
        if (o->crossover) refuse_unused(app, psf_tasks.front(), psf_tasks);
        common.run = [o] { return run_lens_psf(*o); };
    });
}

void prescription_options(CLI::App& app, PrescriptionOptions& o, bool required = true) {
    reads(app.add_option("file", o.input,
                         "Prescription: .dat, .zmx, .seq or .toml (docs/lens_prescriptions.md)"))
        ->required(required)
        ->type_name("FILE");
    number(app, "--f-number", o.f_number,
           "Aperture number n, not below what the lens opens to [default: wide open]", "N", f_numbers);
    number(app, "--focus", o.focus_m,
           "Focus distance from the entrance pupil [default: the film as the file has it, else "
           "infinity]",
           "M", above_0, true);
    number(app, "--wavelength", o.wavelength_nm, "Wavelength [default: the file's]", "NM", wavelengths_nm);
    choice(app, "--focus-by", o.criterion,
           "What is sharp: rays near the axis, or the spot of least RMS radius",
           {{"paraxial", FocusCriterion::paraxial}, {"rms", FocusCriterion::rms_spot}});
    choice(app, "--move", o.move,
           "What moves to focus: the film, or the lens as a whole before a film that stands",
           {{"film", FocusMove::film}, {"lens", FocusMove::lens}});
}

void add_show(CLI::App& lens, ParsedCommand& common) {
    CLI::App& app = *lens.add_subcommand("show", "A prescription's focal lengths, pupils and cross-section");
    const auto o = std::make_shared<LensShowOptions>();
    prescription_options(app, o->lens);
    number(app, "--film-width", o->film_width_mm, "Also the field of view over so much film", "MM", above_0);
    writes(app.add_option("-o,--output", o->output,
                          "Drawing of the lens with rays: .svg, .png, .tif, .jpg or .exr"))
        ->type_name("FILE");
    common_options(app, common);
    app.callback([&common, o] { common.run = [o] { return run_lens_show(*o); }; });
}

void add_lens_trace(CLI::App& lens, ParsedCommand& common) {
    CLI::App& app =
        *lens.add_subcommand("trace", "Exact rays: spot diagrams, impulse responses, curves over the field");
    const auto o = std::make_shared<LensTraceOptions>();
    prescription_options(app, o->lens);
    number(app, "--depth", o->depth_m, "Depth z' of the object [default: --focus, else infinity]", "M",
           above_0, true);
    app.add_option_function<std::string>(
           "--fields",
           [o](const std::string& text) {
               o->fields_deg.clear();
               std::size_t at = 0;
               do {
                   const std::size_t end = std::min(text.find(',', at), text.size());
                   o->fields_deg.push_back(parse_number("--fields", text.substr(at, end - at)));
                   at = end + 1;
               } while (at <= text.size());
           },
           "Angles of the object from the axis at the entrance pupil, -89 to 89 [default: the film's centre, "
           "half and "
           "edge]")
        ->type_name("DEG,...");
    number(app, "--film-width", o->film_width_mm, "Width of the film", "MM", above_0);
    whole(app, "--rays", o->rays, "Rays along each side of the pupil", "N", {.low = 3, .high = 1025});
    writes(app.add_option("-o,--output", o->output,
                          "Spot diagrams: .csv (every ray), .svg, .png, .tif, .jpg or .exr"))
        ->type_name("FILE");
    writes(app.add_option("--curves", o->curves,
                          "Vignetting and distortion over the field: .csv, .svg, .png, .tif, .jpg or .exr"))
        ->type_name("FILE");
    writes(app.add_option("--impulse", o->impulse,
                          "Impulse responses of the fields, side by side, each of energy 1: .exr"))
        ->type_name("FILE");
    number(app, "--pixel-pitch", o->pixel_pitch_um, "Pixel pitch of --impulse", "UM", above_0);
    common_options(app, common);
    app.callback([&app, &common, o] {
        go_with(app, {"--pixel-pitch"}, "--impulse");
        common.run = [o] { return run_lens_trace(*o); };
    });
}

void add_fit(CLI::App& lens, ParsedCommand& common) {
    CLI::App& app =
        *lens.add_subcommand("fit",
                             "The simplest model of a prescription that is as good as asked for; "
                             "or a thin lens from measurements (--pairs) or for a task (--sharp)");
    const auto o = std::make_shared<LensFitOptions>();
    prescription_options(app, o->lens, false);
    const auto limits = fit_limits_options(app);
    app.add_option_function<std::string>(
           "--depths", [o](const std::string& text) { o->depths_m = parse_depths("--depths", text); },
           "Nearest and farthest depth, 0 < A < B, B may be inf [default: 1:100]")
        ->type_name("A:B");
    number(app, "--field", o->field_mm, "Farthest point of the film from its centre", "MM", from_0);
    number(app, "--tolerance-px", o->tolerance_px, "Largest error of the model that is picked", "PX",
           above_0);
    number(app, "--pixel-pitch", o->pixel_pitch_um,
           "Pixel pitch on the film; the default is 36 mm over 1920 px", "UM", above_0);
    whole(app, "--samples", o->samples,
          "Depths and fields that the polynomial is fitted to; errors are measured between them as well", "N",
          {.low = 4, .high = 64});
    common_options(app, common);
    app.callback([&app, &common, o, limits] {
        const std::array given{!o->lens.input.empty(), limits->pairs.has_value(), limits->sharp.has_value(),
                               limits->picture.has_value()};
        const auto tasks = std::count(given.begin(), given.end(), true);
        if (tasks > 1) {
            fail(ExitCode::wrong_arguments,
                 "lens fit: too much to do (got {} of a prescription, --pairs, --sharp and --picture; "
                 "expected one)",
                 tasks);
        }
        for (std::size_t i = 0; i < given.size(); ++i) {
            if (given[i]) refuse_unused(app, fit_tasks[i], fit_tasks);
        }
        common.run = [o, limits] {
            if (limits->picture) return run_lens_fit_picture(*limits);
            if (!o->lens.input.empty()) return run_lens_fit(*o);
            limits->f_number = o->lens.f_number;
            limits->wavelength_nm = o->lens.wavelength_nm.value_or(limits->wavelength_nm);
            return run_lens_fit_limits(*limits);
        };
    });
}

}  // namespace

void add_lens_commands(CLI::App& root, ParsedCommand& common) {
    CLI::App& lens = *root.add_subcommand("lens", "Optics without a scene");
    lens.require_subcommand(1);
    add_coc(lens, common);
    add_dof(lens, common);
    add_psf(lens, common);
    add_show(lens, common);
    add_lens_trace(lens, common);
    add_fit(lens, common);
}

}  // namespace postlens
