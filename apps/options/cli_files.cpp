// The options of the commands that show, compare and join files.
#include <limits>

#include "apps/numbers.h"
#include "apps/options/command_options.h"

namespace postlens {

void add_image(CLI::App& root, CommandOptions& s) {
    CLI::App& app = *root.add_subcommand("image", "The pinhole picture, from the records alone");
    ImageOptions& o = s.image;
    reads(app.add_option("frame", o.input,
                         "Sample file, or an OpenEXR picture of another program, flat or deep"))
        ->required()
        ->type_name("FRAME");
    output_option(app, o.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    crop_option(app, o.crop);
    exposure_option(app, o.exposure, exposure_of_file);
    frame_options(app, s.frames, false);
    foreign_channel_options(app, o.foreign.choice);
    salvage_option(app, o.salvage);
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_frames(s.asked_frames(), s.image); }; });
}

void add_records(CLI::App& root, CommandOptions& s) {
    CLI::App& app =
        *root.add_subcommand("records", "The shading trees at a pixel: every node, its z', W and CoC");
    RecordsOptions& o = s.records;
    reads(app.add_option("frame", o.input, "Sample file"))->required()->type_name("FRAME");
    app.add_option_function<std::string>(
           "--at", [&o](const std::string& text) { o.at = parse_position("--at", text); },
           "Raster position, px")
        ->required()
        ->type_name("X,Y");
    whole(app, "--key", o.key, "Which of the file's instants, 0: the frame's own", "I", from_0);
    lens_options(app, o.lens);
    salvage_option(app, o.salvage);
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_records(s.records); }; });
}

void add_compare(CLI::App& root, CommandOptions& s) {
    CLI::App& app = *root.add_subcommand("compare", "How far a picture is from its reference, in figures");
    CompareCommandOptions& o = s.compare;
    reads(app.add_option("image", o.image, "Picture to judge, or a sample file: its pinhole picture"))
        ->required()
        ->type_name("IMAGE");
    reads(app.add_option("reference", o.reference, "Picture to hold it against, of the same size"))
        ->required()
        ->type_name("REFERENCE");
    reads(app.add_option(
              "--noise", o.noise,
              "An independent render of the reference (another seed, as many rays): tells how good the "
              "reference is and the error above its noise"))
        ->type_name("IMAGE");
    reads(
        app.add_option("--pinhole", o.pinhole,
                       "The pinhole picture: figures also for the affected pixels, where it differs from the "
                       "reference by more than 1/255 (sRGB)"))
        ->type_name("IMAGE");
    writes(app.add_option("--map", o.map, "Write where they differ, as colours with a legend"))
        ->type_name("PNG");
    writes(app.add_option("--side-by-side", o.side_by_side, "Write both pictures, the map and the figures"))
        ->type_name("PNG");
    writes(app.add_option(
               "--map-causes", o.map_causes,
               "Write why each wrong pixel is wrong; needs --frame, and the lens or shutter of the image"))
        ->type_name("PNG");
    reads(app.add_option(
              "--scene", o.retrace.scene,
              "With --map-causes: the scene that the frame was traced from, traced again without one "
              "shortcoming at "
              "a time where the frame alone leaves causes open [default: nothing is]"))
        ->type_name("SCENE");
    number(app, "--metres-per-unit", o.retrace.metres_per_unit,
           "With --scene: size of its unit, m [default: as the sample file was traced]", "X", units_m);
    lumens_option(app, o.retrace.lumens_per_watt, "With --scene: ");
    exposure_option(app, o.exposure, "the reference's");
    crop_option(app, o.crop);
    reads(
        app.add_option("--frame", o.frame, "With --map-causes: the sample file that the image was made from"))
        ->type_name("FRAME");
    number(app, "--f-number", o.lens.f_number,
           "With --map-causes: of the image [default: the frame's; with --shutter a pinhole]", "N", f_numbers,
           true);
    number(app, "--focus", o.lens.focus_m, "With --map-causes: of the image [default: the frame's]", "M",
           above_0, true);
    number(app, "--focal-length", o.lens.focal_length_mm,
           "With --map-causes: of the image [default: the frame's]", "MM", above_0);
    instants(app, "--shutter", o.shutter,
             "With --map-causes: of the image, s of the scene's clock [default: open for an instant]");
    app.add_option_function<std::string>(
           "--depths",
           [&o](const std::string& text) {
               o.depths = parse_whole("--depths", text, depth_counts);
               check_bounds("--depths", *o.depths, text, depth_counts);
               o.method = FocusMethod::scatter;
           },
           "With --map-causes: K of the scatter that made the image, 2 to 4096, to tell what is due to that")
        ->type_name("K");
    number(app, "--fail-psnr", o.limits.least_psnr_db, "Exit with 1 where the PSNR is less", "DB", from_0);
    number(app, "--fail-relmse", o.limits.greatest_relmse, "Exit with 1 where relMSE is more", "X", from_0);
    number(app, "--fail-flip", o.limits.greatest_flip, "Exit with 1 where FLIP is more", "X",
           {.low = 0, .high = 1});
    number(app, "--flip-white", o.flip_white,
           "Luminance that HDR-FLIP takes for white, 0.18 being grey [default: the reference's "
           "maximum and median]",
           "Y", above_0);
    common_options(app, s.common);
    app.callback([&app, &s] {
        go_with(app, {"--f-number", "--focus", "--focal-length", "--shutter", "--depths"}, "--map-causes");
        s.common.run = [&s] { return run_compare(s.compare); };
    });
}

void add_merge(CLI::App& root, CommandOptions& s) {
    CLI::App& app = *root.add_subcommand("merge", "Joins parts made with --share to the undivided result");
    MergeOptions& o = s.merge;
    reads(app.add_option("part", o.parts, "Parts, in any order; of a sweep or a chart, their .json files"))
        ->required()
        ->type_name("PART");
    output_option(app, o.output, "Picture or sample file; of a sweep or a chart, the folder of the parts");
    app.add_flag("--partial", o.partial, "Merge what is there; the rest is black, and is listed");
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_merge(s.merge); }; });
}

void add_info(CLI::App& root, CommandOptions& s) {
    CLI::App& app = *root.add_subcommand("info", "What is in a file: scene, lens, sample file or image");
    app.add_option("file", s.info.input, "Any of them")->required()->type_name("FILE");
    salvage_option(app, s.info.salvage);
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_info(s.info); }; });
}

void add_view(CLI::App& root, CommandOptions& s) {
    CLI::App& app = *root.add_subcommand("view", "Refocus by hand, in a browser on this machine");
    ViewOptions& o = s.view;
    reads(
        app.add_option("frame", o.input, "Sample file, or an OpenEXR picture of another program with depth"))
        ->required()
        ->type_name("FRAME");
    reads(app.add_option("scene", o.scene,
                         "The scene that the frame was traced from: for method auto, rays to compare with, "
                         "and the causes of errors"))
        ->type_name("SCENE");
    app.add_option_function<std::string>(
           "--port",
           [&o](const std::string& text) {
               constexpr OptionRange ports{.low = 0, .high = 65535};
               o.port = parse_whole("--port", text, ports);
               check_bounds("--port", o.port, text, ports);
           },
           "Port on 127.0.0.1; 0: any free one [default: 0]")
        ->type_name("N");
    app.add_flag("--open", o.open, "Open the address in the desktop's browser");
    writes(app.add_option(
               "--export", s.export_view.output,
               "Write one page instead, which needs no server: pictures by focus distance and f-number, and "
               "depths to click on"))
        ->type_name("PAGE.html");
    number(app, "--export-mb", s.export_view.most_mb, "With --export: its greatest size", "MB", above_0);
    common_options(app, s.common);
    app.callback([&app, &s] {
        s.view.threads = s.common.threads;
        s.export_view.input = s.view.input;
        const bool exports = !s.export_view.output.empty();
        if (exports && s.view.scene) {
            fail(
                ExitCode::wrong_arguments,
                "SCENE: not with --export, whose page is made from the records alone (got {}; expected FRAME "
                "only)",
                *s.view.scene);
        }
        for (const char* name : {"--port", "--open"}) {
            if (exports && app.count(name) > 0)
                fail(ExitCode::wrong_arguments, "{}: not with --export, which starts no server", name);
        }
        go_with(app, {"--export-mb"}, "--export");
        s.common.run = [&s] {
            return s.export_view.output.empty() ? run_view(s.view) : export_view(s.export_view);
        };
    });
}

}  // namespace postlens
