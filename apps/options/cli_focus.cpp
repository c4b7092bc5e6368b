// The options of `focus`, `motionblur` and `shoot`, which simulate a lens, a shutter or both.
#include <limits>

#include "apps/numbers.h"
#include "apps/options/command_options.h"
#include "sweep/picture_maker.h"

namespace postlens {
namespace {

void retrace_options(CLI::App& app, RetraceOptions& o) {
    reads(
        app.add_option("--scene", o.scene,
                       "The scene that the frame was traced from: rays in it replace what the records do not "
                       "determine, and measure the error; focus does so by hybrid and auto [default: no "
                       "rays]"))
        ->type_name("SCENE");
    number(
        app, "--metres-per-unit", o.metres_per_unit,
        "Size of the unit of the scene, or of another program's depths, m [default: as the sample file was "
        "traced; 1 of another program's picture]",
        "X", units_m);
    lumens_option(app, o.lumens_per_watt, "With --scene: ");
    writes(app.add_option("--explain", o.explain,
                          "Picture of what hybrid and auto did where: blue scattered, grey light field "
                          "(auto: the paler the more views), red traced again"))
        ->type_name("PNG");
}

void target_option(CLI::App& app, std::optional<double>& to, const std::string& without) {
    number(app, "--target-db", to,
           "With --method auto: PSNR wanted of the picture [default: " + without + "]", "DB",
           target_decibels);
}

}  // namespace

void add_focus(CLI::App& root, CommandOptions& s) {
    CLI::App& app = *root.add_subcommand("focus", "The picture through a lens, from the records alone");
    FocusOptions& o = s.focus;
    reads(app.add_option("frame", o.input,
                         "Sample file; or an OpenEXR picture of another program with depth, flat or deep "
                         "(docs/inputs.md)"))
        ->required()
        ->type_name("FRAME");
    output_option(app, o.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    crop_option(app, o.crop);
    exposure_option(app, o.exposure, exposure_of_file);
    frame_options(app, s.frames, false);
    dry_run_option(app, s.common);
    share_option(app, s.share, "rows of the picture, or every N-th of --frames");
    lens_options(app, o.lens);
    impulse_options(app, o.impulse);
    choice(
        app, "--method", o.method,
        "How; auto: the usual method for what the file holds, with --target-db or --scene as many views and "
        "rays as that takes",
        {{"scatter", FocusMethod::scatter},
         {"layers", FocusMethod::layers},
         {"lightfield", FocusMethod::lightfield},
         {"hybrid", FocusMethod::hybrid},
         {"auto", FocusMethod::automatic},
         {"pinhole", FocusMethod::pinhole}});
    whole(app, "--depths", o.depths,
          "Number K of impulse responses [default: as many as keep CoCs right to half a pixel]", "K",
          depth_counts);
    whole(app, "--views", o.views,
          fmt::format("Points of the lens that lightfield and hybrid look from [default: {}]",
                      default_lens_views),
          "M", lens_view_counts);
    target_option(app, o.target_db,
                  fmt::format("{:g} with --scene or --explain, else the usual method", default_target_db));
    retrace_options(app, o.retrace);
    foreign_channel_options(app, o.foreign.choice);
    foreign_camera_options(app, o.foreign.camera);
    behind_options(app, o.foreign);
    object_options(app, o.foreign);
    choice(app, "--spacing", o.spacing, "Spacing of the K depths: equal steps in z' or in 1/z'",
           {{"linear", DepthSpacing::linear}, {"inverse", DepthSpacing::inverse}});
    choice(app, "--depth-model", o.depth_model,
           "Depth of what mirrors and glass show: W, the path's length, or the first hit",
           {{"W", DepthModel::ray_differentials},
            {"path", DepthModel::path},
            {"first-hit", DepthModel::first_hit}});
    predict_option(app, o.predict);
    strict_option(app, o.strict);
    salvage_option(app, o.salvage);
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_frames(s.asked_frames(), s.focus); }; });
}

void add_motionblur(CLI::App& root, CommandOptions& s) {
    CLI::App& app =
        *root.add_subcommand("motionblur",
                             "The picture of an open shutter, from the records alone, or from a flat OpenEXR "
                             "picture with motion vectors (docs/motion_vectors.md)");
    MotionBlurOptions& o = s.motionblur;
    reads(app.add_option(
              "frame", o.input,
              "Sample file; or a picture with R, G, B, vectors and Z: then --shutter is in frames, 0 this "
              "one, 1 the next"))
        ->required()
        ->type_name("FRAME");
    output_option(app, o.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    crop_option(app, o.settings.crop);
    exposure_option(app, o.exposure, exposure_of_file);
    frame_options(app, s.frames, false);
    dry_run_option(app, s.common);
    share_option(app, s.share, "rows of the picture, or every N-th of --frames");
    shutter_options(app, o.shutter, o.curve, "the file's exposure, from the frame's instant on");
    reads(app.add_option("--paths", o.paths,
                         "Paths of objects, in place of what the file says (docs/motion_paths.md)"))
        ->type_name("PATHS.toml");
    app.add_option_function<std::string>(
           "--vectors",
           [&o](const std::string& text) { o.vectors.channels = parse_names("--vectors", text); },
           "Channels of a picture's forward motion vectors [default: forward.u/.v, Vector.Z/.W, motion.x/.y "
           "or velocity.x/.y]")
        ->type_name("U,V");
    app.add_option_function<std::string>(
           "--vector-scale,--vectors-scale",
           [&o](const std::string& text) {
               const auto [x, y] = parse_scale("--vector-scale", text);
               o.vectors.scale = glm::dvec2(x, y);
           },
           "What 1 in U and in V stands for, px to the right and px down; 1,-1 where V points up [default: "
           "as the channels' names say, 1,1 with --vectors]")
        ->type_name("X[,Y]");
    app.add_option_function<std::string>(
           "--vector-offset",
           [&o](const std::string& text) {
               const auto [x, y] = parse_scale("--vector-offset", text);
               o.vectors.offset = glm::dvec2(x, y);
           },
           "What U and V are where nothing moves; the way is (value - offset) times the scale [default: 0]")
        ->type_name("X[,Y]");
    reads(app.add_option("--vectors-file", o.vectors.file,
                         "Of another program's picture: where the vectors have a file of their own"))
        ->type_name("PICTURE.exr");
    foreign_channel_options(app, o.foreign);
    number(app, "--fit-paths", o.settings.fit_px,
           "Replace the paths of convolve by splines of few knots within so much [default: paths "
           "as they are]",
           "PX", above_0);
    choice(
        app, "--method", o.settings.method,
        "convolve: object by path; lightfield: surfaces at many instants; auto: convolve for what moves as a "
        "whole, lightfield for the rest",
        {{"auto", MotionMethod::automatic},
         {"convolve", MotionMethod::convolve},
         {"lightfield", MotionMethod::lightfield}});
    whole(app, "--views", o.settings.views,
          "Instants of lightfield [default: one for two pixels of the longest way, 131, 257 or 521]", "M",
          lens_view_counts);
    target_option(app, o.target_db, fmt::format("{:g} with --scene", default_target_db));
    retrace_options(app, o.retrace);
    predict_option(app, o.predict);
    strict_option(app, o.strict);
    salvage_option(app, o.salvage);
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_frames(s.asked_frames(), s.motionblur); }; });
}

void add_shoot(CLI::App& root, CommandOptions& s) {
    CLI::App& app = *root.add_subcommand(
        "shoot", "The picture through a lens and an open shutter at once, from the records alone");
    FocusOptions& o = s.shoot.focus;
    o.method = FocusMethod::lightfield;
    reads(app.add_option("frame", o.input, "Sample file"))->required()->type_name("FRAME");
    output_option(app, o.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    crop_option(app, o.crop);
    exposure_option(app, o.exposure, "the sample file's");
    frame_options(app, s.frames, false);
    dry_run_option(app, s.common);
    share_option(app, s.share, "rows of the picture, or every N-th of --frames");
    lens_options(app, o.lens);
    impulse_options(app, o.impulse);
    shutter_options(app, s.shoot.shutter, s.shoot.curve, "the file's exposure, from the frame's instant on");
    reads(app.add_option("--paths", s.shoot.paths,
                         "Paths of objects, in place of what the file says (docs/motion_paths.md)"))
        ->type_name("PATHS.toml");
    choice(app, "--method", o.method,
           "lightfield; hybrid: traces again what no record shows; auto: the views that --target-db takes, "
           "tile by "
           "tile",
           {{"lightfield", FocusMethod::lightfield},
            {"hybrid", FocusMethod::hybrid},
            {"auto", FocusMethod::automatic}});
    whole(app, "--views", o.views,
          fmt::format("Points of the lens, each at its own instant [default: {}]", default_shutter_views),
          "M", lens_view_counts);
    target_option(app, o.target_db, fmt::format("{:g}", default_target_db));
    retrace_options(app, o.retrace);
    predict_option(app, o.predict);
    strict_option(app, o.strict);
    salvage_option(app, o.salvage);
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_frames(s.asked_frames(), s.shoot); }; });
}

}  // namespace postlens
