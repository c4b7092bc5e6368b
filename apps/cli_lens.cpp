#include <memory>

#include "apps/cli_options.h"
#include "apps/lens_command.h"
#include "apps/lens_fit_limits_command.h"
#include "apps/lens_psf_command.h"

namespace postlens {
namespace {

void lens_numbers(CLI::App& app, LensCommandOptions& o) {
    number(app, "--focal-length", o.focal_length_mm, "Focal length F, more than 0", "MM")->required();
    number(app, "--f-number", o.f_number, "Aperture number n, more than 0; inf: pinhole", "N", true)
        ->required();
    number(app, "--focus", o.focus_m, "Focus distance s, more than F", "M", true)->required();
    number(app, "--coc-limit", o.coc_limit_mm, "Widest circle of confusion that counts as sharp", "MM");
    number(app, "--pixel-pitch", o.pixel_pitch_um,
           "Pixel pitch on the film; the default is 36 mm over 1920 px", "UM");
}

void add_coc(CLI::App& lens, ParsedCommand& common) {
    CLI::App& app =
        *lens.add_subcommand("coc", "Circle of confusion of what lies at a depth, on a film at V");
    const auto o = std::make_shared<LensCommandOptions>();
    lens_numbers(app, *o);
    number(app, "--depth", o->depth_m, "Depth z' of the object, more than 0", "M", true)->required();
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
    app.add_option("output", o->output, "Picture of one channel, Y")->type_name("OUT.exr");
    number(app, "--focal-length", o->focal_length_mm, "Focal length F, more than 0", "MM");
    number(app, "--f-number", o->f_number, "Aperture number n, more than 0; inf: pinhole", "N", true);
    number(app, "--focus", o->focus_m, "Focus distance s, more than F", "M", true);
    number(app, "--depth", o->depth_m, "Depth z' of the point, more than 0", "M", true);
    number(app, "--wavelength", o->wavelength_nm, "Wavelength, 100 to 20000 [default: 550]", "NM");
    number(app, "--pixel-pitch", o->pixel_pitch_um, "Pixel pitch on the film", "UM");
    whole(app, "--size", o->size_px,
          "Width and height, to 16384; 0: what holds 99% of the energy, at most 1025", "PX");
    impulse_options(app, o->impulse);
    app.add_option(
           "--profile", o->profile,
           "Also write a table: radius, v, intensity, encircled energy; with --crossover: f-number, Airy "
           "disc, circle of confusion, pixel")
        ->type_name("FILE.csv");
    app.add_flag("--crossover", o->crossover,
                 "Say instead from which f-number on diffraction is wider than defocus and than a pixel");
    common_options(app, common);
    app.callback([&common, o] { common.run = [o] { return run_lens_psf(*o); }; });
}

void add_fit(CLI::App& lens, ParsedCommand& common) {
    CLI::App& app =
        *lens.add_subcommand("fit", "A thin lens from measurements (--pairs) or for a task (--sharp)");
    const auto limits = fit_limits_options(app);
    common_options(app, common);
    app.callback([&common, limits] { common.run = [limits] { return run_lens_fit_limits(*limits); }; });
}

}  // namespace

void add_lens_commands(CLI::App& root, ParsedCommand& common) {
    CLI::App& lens = *root.add_subcommand("lens", "Optics without a scene");
    lens.require_subcommand(1);
    add_coc(lens, common);
    add_dof(lens, common);
    add_psf(lens, common);
    add_fit(lens, common);
}

}  // namespace postlens
