#include "apps/options/cli_chart.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "apps/commands/atlas_command.h"
#include "apps/commands/chart_command.h"
#include "apps/numbers.h"

namespace postlens {
namespace {

void list_option(CLI::App& app, const std::string& name, std::vector<int>& to, const std::string& help) {
    app.add_option_function<std::string>(
           name, [&to, name](const std::string& text) { to = parse_whole_list(name, text); }, help)
        ->type_name("N,N,...");
}

/// Throws if --atlas is combined with an option that it does not use. Each case of the atlas states its own
/// settings.
void refuse_beside_atlas(const CLI::App& app) {
    constexpr std::array<std::string_view, 7> used{"--atlas", "--output", "--restart",     "--threads",
                                                   "--quiet", "--json",   "--requeue-code"};
    for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return o->count() > 0; })) {
        const std::string name = option->get_name();
        if (std::find(used.begin(), used.end(), name) != used.end()) continue;
        fail(ExitCode::wrong_arguments,
             "{}: not with --atlas, whose cases state their own settings (expected a scene)", name);
    }
}

}  // namespace

void add_chart_command(CLI::App& root, ParsedCommand& common) {
    CLI::App& app = *root.add_subcommand(
        "chart", "Every method and distributed rays on one scene: speed against accuracy, as a page");
    const auto o = std::make_shared<ChartOptions>();
    ChartRequest& r = o->request;
    auto scene = std::make_shared<std::string>();
    scene_options(app, *scene, r.units, r.camera, r.camera_name);
    CLI::Option* scene_option = app.get_option("scene")->required(false);
    auto atlas = std::make_shared<AtlasOptions>();
    CLI::Option* atlas_option =
        reads(
            app.add_option("--atlas", atlas->cases,
                           "Instead of a scene: the cases of this folder, each a scene that breaks a method "
                           "[default: tests/stability]; exit code 1 where one is not as it says"))
            ->expected(0, 1)
            ->default_str("tests/stability")
            ->type_name("FOLDER")
            ->excludes(scene_option);
    writes(app.add_option("-o,--output", o->output,
                          "Folder, made if it is not there: index.html, chart.csv, .json and .md, charts and "
                          "pictures; with "
                          "--atlas index.html, failures.md and pictures"))
        ->required()
        ->type_name("DIR");
    exposure_option(app, o->exposure, "0");
    number(app, "--focal-length", r.focal_length_mm, "F [default: the camera's film distance]", "MM",
           above_0);
    number(app, "--f-number", r.f_number,
           "Aperture number; inf with --shutter: motion alone [default: the camera's]", "N", f_numbers, true);
    number(app, "--focus", r.focus_m, "Focus distance [default: the camera's]", "M", above_0, true);
    instants(app, "--shutter", r.shutter,
             "Open between these instants of the scene's clock, s [default: open for an instant]");
    list_option(app, "--rays", r.spp,
                "Samples per pixel of the rays, each 1 to 1048576 [default: 1,4,16,64,256,1024]");
    list_option(app, "--views", r.views, "M of lightfield and hybrid, each 1 to 4096 [default: 16,64,256]");
    list_option(app, "--depths", r.depths, "K of scatter, each 2 to 4096 [default: 8,32,128]");
    whole(app, "--reference-spp", r.reference_spp, "Samples per pixel of each of the reference's two halves",
          "N", {.low = 1, .high = 1 << 19});
    auto reference = std::make_shared<std::optional<std::string>>();
    auto noise = std::make_shared<std::optional<std::string>>();
    reads(app.add_option("--reference", *reference, "Hold all pictures against this one [default: rendered]"))
        ->type_name("IMAGE");
    reads(app.add_option("--noise", *noise, "With --reference: an independent render of it"))
        ->type_name("IMAGE");
    whole(app, "--rounds", r.rounds, "How often everything is measured, in turns", "N",
          {.low = 1, .high = 100});
    number(app, "--once-above", r.once_above_s, "Measure once what takes longer", "S", from_0);
    app.add_flag("--restart", o->restart, "Begin anew in a folder that holds a chart or an atlas");
    app.add_option_function<std::string>(
           "--share", [&r](const std::string& text) { r.share = parse_share("--share", text); },
           "Only every N-th point, from the I-th, for `merge` (docs/farm.md); not with --atlas")
        ->type_name("I/N");
    app.add_flag_callback(
        "--no-plots", [&r] { r.plots = false; }, "No SVG and PNG: gnuplot is not needed");
    common_options(app, common);
    app.callback([=, &app, &common] {
        o->request.join = common.join;
        // Tells whether --atlas is given. This is read now, because CLI11 has already destroyed
        // `atlas_option` when `common.run` is called.
        const bool of_atlas = atlas_option->count() > 0;
        if (of_atlas) refuse_beside_atlas(app);
        common.run = [=, asked = asked_for(app), words = words_of(app)] {
            if (of_atlas) {
                atlas->output = o->output;
                atlas->restart = o->restart;
                return run_atlas_command(*atlas);
            }
            if (scene->empty())
                fail(ExitCode::wrong_arguments, "SCENE: missing (got nothing; expected a scene or --atlas)");
            o->request.scene = *scene;
            o->request.exposure_stops = o->exposure.stops.value_or(0);
            o->request.exposure_auto = o->exposure.automatic;
            if (*reference) o->request.reference = **reference;
            if (*noise) o->request.second_reference = **noise;
            if (o->request.share) o->request.part = mark_of_items(*o->request.share, asked, words);
            return run_chart_command(*o);
        };
    });
}

}  // namespace postlens
