#include <memory>

#include "apps/cli_options.h"
#include "apps/lens_command.h"

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

}  // namespace

void add_lens_commands(CLI::App& root, ParsedCommand& common) {
    CLI::App& lens = *root.add_subcommand("lens", "Optics without a scene");
    lens.require_subcommand(1);
    add_coc(lens, common);
    add_dof(lens, common);
}

}  // namespace postlens
