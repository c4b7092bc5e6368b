#include "apps/cli.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <span>

#include "apps/numbers.h"
#include "apps/options/cli_chart.h"
#include "apps/options/cli_options.h"
#include "apps/options/frame_range.h"
#include "apps/view/view_command.h"
#include "apps/view/view_export.h"

#ifndef POSTLENS_VERSION
#define POSTLENS_VERSION "unknown"
#endif

namespace postlens {
namespace {

constexpr const char* exposure_of_file = "the sample file's; 0 of another program's picture";

// All values that the parser sets. The parsed command owns them.
struct State {
    ParsedCommand common;
    TraceOptions trace;
    RenderOptions render;
    FocusOptions focus;
    MotionBlurOptions motionblur;
    ShootOptions shoot;
    RecordsOptions records;
    CompareCommandOptions compare;
    ImageOptions image;
    InfoOptions info;
    ViewOptions view;
    ViewExportOptions export_view;
    FrameOptions frames;
    std::optional<Share> share;
    MergeOptions merge;
    /// The options of --frames, with `speak` set from the common options.
    [[nodiscard]] const FrameOptions& asked_frames() {
        frames.speak = !common.quiet && !common.json;
        return frames;
    }
};

/// `what`: text of the help that says what is divided into shares without --frames.
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
    app.add_flag("--keep", to.keep, "With --frames: leave out those whose output is there and whole");
    if (in_time)
        number(app, "--fps", to.fps, "With --frames: frame n is at n / FPS s [default: 24]", "FPS", above_0);
}

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
           "[default: 1]")
        ->type_name("K|auto");
}

void add_trace(CLI::App& root, State& s) {
    CLI::App& app = *root.add_subcommand("trace", "Trace a scene through a pinhole into a sample file");
    TraceOptions& o = s.trace;
    TraceSettings& t = o.settings;
    scene_options(app, o.scene, o.units, t.camera, t.camera_name);
    output_option(app, o.output, "Sample file (OpenEXR)");
    exposure_option(app, o.exposure, "0");
    frame_options(app, s.frames, true);
    share_option(app, s.share, "rows of the records, or every N-th of --frames");
    number(app, "--time", t.time_s, "Instant of the trace on the scene's clock [default: the scene's]", "S",
           any_value);
    // --focal-length exists here only to be refused with an explanation: with other commands it sets the
    // focal length of the lens, not the field of view.
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
           "--for-f-number 3 where objects end, as records no finer than that bound how sharp a lens is]")
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
    number(app, "--for-focus", t.for_focus_m, "Size the file for this focus distance", "M", above_0, true);
    app.add_flag(
        "--plan", o.plan,
        "Choose subdivision, hidden layers, overscan and keys for the lens and shutter named and for "
        "--target-db, from a look at a quarter of the size; says what size and time to expect");
    number(app, "--target-db", o.target_db, "With --plan: PSNR that pictures from the file are to reach",
           "DB", target_decibels);
    app.add_flag("--force", o.force,
                 "Trace even where the file will not fit on its disk, as a look at a few rows tells");
    choice(app, "--compression", t.compression, "Compression of the records",
           {{"none", RecordCompression::none},
            {"rle", RecordCompression::rle},
            {"zips", RecordCompression::zips}});
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_frames(s.asked_frames(), s.trace); }; });
}

void add_render(CLI::App& root, State& s) {
    CLI::App& app =
        *root.add_subcommand("render", "The picture by distributed rays over lens and time: the reference");
    RenderOptions& o = s.render;
    RenderSettings& r = o.settings;
    scene_options(app, o.scene, o.units, r.camera, r.camera_name);
    output_option(app, o.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    crop_option(app, r.crop);
    exposure_option(app, o.exposure, "0");
    frame_options(app, s.frames, true);
    share_option(app, s.share, "rows of the picture, or every N-th of --frames");
    choice(app, "--share-by", s.render.share_by_samples,
           "What --share divides: rows of the picture, or the samples of every pixel",
           {{"tiles", false}, {"samples", true}});
    whole(app, "--spp", r.spp, "Samples per pixel", "N", {.low = 1, .high = 1 << 20})->required();
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
    app.callback([&s] { s.common.run = [&s] { return run_frames(s.asked_frames(), s.render); }; });
}

void add_image(CLI::App& root, State& s) {
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

void add_records(CLI::App& root, State& s) {
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

void retrace_options(CLI::App& app, RetraceOptions& o) {
    reads(app.add_option("--scene", o.scene,
                         "The scene that the frame was traced from: rays look wherever the records do not "
                         "tell what a point "
                         "of the lens sees [default: they tell what they can]"))
        ->type_name("SCENE");
    number(app, "--metres-per-unit", o.metres_per_unit,
           "Size of the unit of the scene, or of another program's depths, m [default: 1]", "X", units_m);
    lumens_option(app, o.lumens_per_watt, "With --scene: ");
    writes(app.add_option(
               "--explain", o.explain,
               "Picture of what was done where: blue scattered, grey light field (auto: the paler the more "
               "views), red traced again"))
        ->type_name("PNG");
}

void target_option(CLI::App& app, std::optional<double>& to, const std::string& without) {
    number(app, "--target-db", to,
           "With --method auto: PSNR wanted of the picture [default: " + without + "]", "DB",
           target_decibels);
}

void add_focus(CLI::App& root, State& s) {
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
    whole(app, "--depths", o.depths, "Number K of impulse responses [default: CoC right to half a pixel]",
          "K", depth_counts);
    whole(app, "--views", o.views, "Points of the lens that lightfield and hybrid look from", "M",
          lens_view_counts);
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
    app.add_flag("--strict", o.strict, "Exit with 6 where the file does not suffice for the request");
    salvage_option(app, o.salvage);
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_frames(s.asked_frames(), s.focus); }; });
}

void add_motionblur(CLI::App& root, State& s) {
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
          "Instants of lightfield [default: one for two pixels of the longest way, 128 to 512]", "M",
          lens_view_counts);
    predict_option(app, o.predict);
    app.add_flag("--strict", o.strict, "Exit with 6 where the file does not suffice for the request");
    salvage_option(app, o.salvage);
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_frames(s.asked_frames(), s.motionblur); }; });
}

void add_shoot(CLI::App& root, State& s) {
    CLI::App& app = *root.add_subcommand(
        "shoot", "The picture through a lens and an open shutter at once, from the records alone");
    FocusOptions& o = s.shoot.focus;
    o.method = FocusMethod::lightfield;
    o.views = 128;
    reads(app.add_option("frame", o.input, "Sample file"))->required()->type_name("FRAME");
    output_option(app, o.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    crop_option(app, o.crop);
    exposure_option(app, o.exposure, "the sample file's");
    frame_options(app, s.frames, false);
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
    whole(app, "--views", o.views, "Points of the lens, each at its own instant", "M", lens_view_counts);
    target_option(app, o.target_db, fmt::format("{:g}", default_target_db));
    retrace_options(app, o.retrace);
    predict_option(app, o.predict);
    app.add_flag("--strict", o.strict, "Exit with 6 where the file does not suffice for the request");
    salvage_option(app, o.salvage);
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_frames(s.asked_frames(), s.shoot); }; });
}

void add_compare(CLI::App& root, State& s) {
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
              "--scene", o.scene,
              "With --map-causes: the scene that the frame was traced from, traced again without one "
              "shortcoming at "
              "a time where the frame alone leaves causes open [default: nothing is]"))
        ->type_name("SCENE");
    number(app, "--metres-per-unit", o.metres_per_unit, "With --scene: size of its unit", "X", units_m);
    lumens_option(app, o.lumens_per_watt, "With --scene: ");
    exposure_option(app, o.exposure, "the reference's");
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
               o.depths = parse_whole("--depths", text);
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
    app.callback([&s] { s.common.run = [&s] { return run_compare(s.compare); }; });
}

void add_merge(CLI::App& root, State& s) {
    CLI::App& app = *root.add_subcommand("merge", "Joins parts made with --share to the undivided result");
    MergeOptions& o = s.merge;
    reads(app.add_option("part", o.parts, "Parts, in any order"))->required()->type_name("PART");
    output_option(app, o.output, "Picture: .exr (scene-linear), .png, .tif or .jpg (sRGB)");
    app.add_flag("--partial", o.partial, "Merge what is there; the rest is black, and is listed");
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_merge(s.merge); }; });
}

void add_info(CLI::App& root, State& s) {
    CLI::App& app = *root.add_subcommand("info", "What is in a file: scene, lens, sample file or image");
    app.add_option("file", s.info.input, "Any of them")->required()->type_name("FILE");
    salvage_option(app, s.info.salvage);
    common_options(app, s.common);
    app.callback([&s] { s.common.run = [&s] { return run_info(s.info); }; });
}

void add_view(CLI::App& root, State& s) {
    CLI::App& app = *root.add_subcommand("view", "Refocus by hand, in a browser on this machine");
    ViewOptions& o = s.view;
    reads(
        app.add_option("frame", o.input, "Sample file, or an OpenEXR picture of another program with depth"))
        ->required()
        ->type_name("FRAME");
    reads(app.add_option(
              "scene", o.scene,
              "The scene that the frame was traced from: for method auto, and for rays to compare with"))
        ->type_name("SCENE");
    app.add_option_function<std::string>(
           "--port",
           [&o](const std::string& text) {
               o.port = parse_whole("--port", text);
               check_bounds("--port", o.port, text, {.low = 0, .high = 65535});
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
    app.callback([&s] {
        s.view.threads = s.common.threads;
        s.export_view.input = s.view.input;
        s.common.run = [&s] {
            return s.export_view.output.empty() ? run_view(s.view) : export_view(s.export_view);
        };
    });
}

// Reports an unknown option or subcommand by name. CLI11 only says that a subcommand is required.
void check_subcommand(const CLI::App& app, std::span<const std::string> arguments) {
    if (arguments.empty() || app.get_subcommands([](const CLI::App*) { return true; }).empty()) return;
    if (arguments[0].starts_with('-')) {
        if (app.get_option_no_throw(arguments[0]) != nullptr) return;
        fail(ExitCode::wrong_arguments, "unknown option (got {}; expected a subcommand, see {} --help)",
             arguments[0], app.get_name());
    }
    std::string known;
    for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (sub->get_name() == arguments[0]) return check_subcommand(*sub, arguments.subspan(1));
        known += (known.empty() ? "" : ", ") + sub->get_name();
    }
    fail(ExitCode::wrong_arguments, "unknown subcommand (got {}; expected one of {})", arguments[0], known);
}

}  // namespace

ParsedCommand parse_command_line(std::vector<std::string> arguments, const InProcess& in_process) {
    const auto state = std::make_shared<State>();
    state->common.join = in_process.join;
    state->merge.run_words = [](std::vector<std::string> words, Join join) {
        return parse_command_line(std::move(words), {.join = join}).run();
    };
    state->image.kept = state->focus.kept = state->shoot.focus.kept = state->motionblur.kept =
        in_process.kept;
    CLI::App app("postlens: render once through a pinhole, apply the lens and the shutter afterwards",
                 "postlens");
    app.set_version_flag("--version", "postlens " POSTLENS_VERSION);
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    add_trace(app, *state);
    add_image(app, *state);
    add_records(app, *state);
    add_render(app, *state);
    add_focus(app, *state);
    add_motionblur(app, *state);
    add_shoot(app, *state);
    add_sweep(app, state->common);
    add_lens_commands(app, state->common);
    add_compare(app, *state);
    add_chart_command(app, state->common);
    add_view(app, *state);
    add_merge(app, *state);
    add_info(app, *state);
    check_subcommand(app, arguments);
    if (in_process.pictures_stay) {
        for (const char* name : {"image", "focus", "shoot", "motionblur", "render"}) {
            app.get_subcommand(name)->get_option("--output")->required(false);
        }
    }
    std::reverse(arguments.begin(), arguments.end());  // CLI11 parses the vector from its end
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
    refuse_shared_files(files_of(app), state->frames.frames);
    if (state->frames.frames) {
        state->frames.asked_for = [asked = asked_for(app)](int frame) {
            return asked.fingerprint(
                [frame](const AskedFor::Input& i) { return FrameName(i.path, i.hashes).of(frame); });
        };
    }
    if (state->share) {
        state->frames.shared =
            SharedWork{*state->share, [asked = asked_for(app)] { return asked.fingerprint(); }, {}};
    }
    ParsedCommand out = state->common;
    // The call owns a reference to the state, because its options are stored there.
    out.run = [state] { return state->common.run(); };
    return out;
}

}  // namespace postlens
