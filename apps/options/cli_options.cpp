#include "apps/options/cli_options.h"

#include <algorithm>
#include <tuple>

#include "apps/numbers.h"
#include "apps/options/frame_range.h"

namespace postlens {
namespace {

/// Inserts the range of accepted values into a help text, between its first clause and the default.
std::string with_bounds(const std::string& help, const OptionRange& bounds) {
    const std::string text = bounds.text();
    if (text.empty()) return help;
    const std::size_t at = std::min({help.find("; "), help.find(" [default:"), help.size()});
    return help.substr(0, at) + ", " + text + help.substr(at);
}

/// Adds an option whose value is parsed by parse(name, text), checked against the bounds, and stored in `to`.
template <typename To, typename Parse>
CLI::Option* bounded(CLI::App& app, const std::string& name, To& to, const std::string& help,
                     const OptionRange& bounds, const Parse& parse) {
    return app.add_option_function<std::string>(
        name,
        [&to, name, bounds, parse](const std::string& text) {
            const auto value = parse(name, text);
            check_bounds(name, value, text, bounds);
            to = value;
        },
        with_bounds(help, bounds));
}

auto whole_within(const OptionRange& bounds) {
    return [bounds](const std::string& option, const std::string& text) {
        return parse_whole(option, text, bounds);
    };
}

template <typename To>
CLI::Option* number_into(CLI::App& app, const std::string& name, To& to, const std::string& help,
                         const std::string& unit, const OptionRange& bounds, bool infinite) {
    const auto parse = [infinite](const std::string& option, const std::string& text) {
        return parse_number(option, text, infinite);
    };
    return bounded(app, name, to, help, bounds, parse)->type_name(infinite ? unit + "|inf" : unit);
}

}  // namespace

CLI::Option* number(CLI::App& app, const std::string& name, std::optional<double>& to,
                    const std::string& help, const std::string& unit, const OptionRange& bounds,
                    bool infinite) {
    return number_into(app, name, to, help, unit, bounds, infinite);
}

CLI::Option* number(CLI::App& app, const std::string& name, double& to, const std::string& help,
                    const std::string& unit, const OptionRange& bounds, bool infinite) {
    return number_into(app, name, to, fmt::format("{} [default: {:g}]", help, to), unit, bounds, infinite);
}

CLI::Option* whole(CLI::App& app, const std::string& name, int& to, const std::string& help,
                   const std::string& unit, const OptionRange& bounds) {
    return bounded(app, name, to, fmt::format("{} [default: {}]", help, to), bounds, whole_within(bounds))
        ->type_name(unit);
}

CLI::Option* whole(CLI::App& app, const std::string& name, std::optional<int>& to, const std::string& help,
                   const std::string& unit, const OptionRange& bounds) {
    return bounded(app, name, to, help, bounds, whole_within(bounds))->type_name(unit);
}

CLI::Option* required_number(CLI::App& app, const std::string& name, double& to, const std::string& help,
                             const std::string& unit, const OptionRange& bounds, bool infinite) {
    return number_into(app, name, to, help, unit, bounds, infinite)->required();
}

CLI::Option* required_whole(CLI::App& app, const std::string& name, int& to, const std::string& help,
                            const std::string& unit, const OptionRange& bounds) {
    return bounded(app, name, to, help, bounds, whole_within(bounds))->type_name(unit)->required();
}

CLI::Option* instants(CLI::App& app, const std::string& name, std::optional<TimeSpan>& to,
                      const std::string& help) {
    return app
        .add_option_function<std::string>(
            name,
            [&to, name](const std::string& text) {
                const auto [open, close] = parse_span(name, text);
                to = TimeSpan{open, close};
                check_shutter(name.c_str(), *to);
            },
            help)
        ->type_name("OPEN:CLOSE");
}

void go_with(const CLI::App& app, std::initializer_list<const char*> options, const std::string& other) {
    if (app.count(other) > 0) return;
    for (const char* option : options) {
        if (app.count(option) > 0)
            fail(ExitCode::wrong_arguments, "{}: goes with {} (got it alone)", option, other);
    }
}

void common_options(CLI::App& app, ParsedCommand& to) {
    whole(app, "--threads", to.threads, "Threads to use, 0: all the machine has", "N",
          {.low = 0, .high = 4096});
    app.add_flag("--quiet", to.quiet, "No progress, no summary, no warnings; errors only");
    app.add_flag("--json", to.json, "The result as JSON on standard output");
    whole(app, "--requeue-code", to.requeue_code,
          "Exit code where SIGTERM or SIGUSR1 ends the command, so that a batch system takes it up again",
          "N", {.low = 1, .high = 255});
}

void dry_run_option(CLI::App& app, ParsedCommand& to) {
    app.add_flag(
        "--dry-run", to.dry_run,
        "Write nothing, but tell what would be written, and the memory and the seconds of every share of "
        "--share, from runs of small parts (docs/farm.md)");
}

void predict_option(CLI::App& app, bool& to) {
    app.add_flag(
        "--predict", to,
        "Predict the PSNR of the picture without the error of the records, and the least with it, by "
        "tile with --json: compares it with a light field of as many further views, 64 at least");
}

void strict_option(CLI::App& app, bool& to) {
    app.add_flag("--strict", to, "Exit with 6 after any warning but that of the exposure");
}

void salvage_option(CLI::App& app, bool& to) {
    app.add_flag("--salvage", to,
                 "Read the intact rows of a damaged or truncated sample file; the others count as empty, and "
                 "a warning names them (docs/files.md)");
}

void output_option(CLI::App& app, std::string& to, const std::string& help) {
    writes(app.add_option("-o,--output", to, help))->required()->type_name("FILE");
}

void crop_option(CLI::App& app, std::optional<Crop>& to) {
    app.add_option_function<std::string>(
           "--crop", [&to](const std::string& text) { to = parse_crop("--crop", text); },
           "Only this part of the picture: W x H pixels from X,Y on, 0,0 at the upper left [default: all]")
        ->type_name("X,Y,W,H");
}

// Adds the lens options. `source` states the default in each help text, for example "the file's".
void lens_options(CLI::App& app, LensOptions& to, const std::string& source) {
    const std::string otherwise = " [default: " + source + "]";
    number(app, "--f-number", to.f_number, "Aperture number n; inf: pinhole" + otherwise, "N", f_numbers,
           true);
    number(app, "--focal-length", to.focal_length_mm, "Focal length F" + otherwise, "MM", above_0);
    auto* focus = number(app, "--focus", to.focus_m, "Focus distance s" + otherwise, "M", above_0, true);
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

void impulse_options(CLI::App& app, Impulse& to, bool on_axis) {
    reads_of_impulse(app.add_option_function<std::string>(
                         "--impulse",
                         [&to, on_axis](const std::string& text) {
                             const Impulse kind = parse_impulse("--impulse", text, !on_axis);
                             to.kind = kind.kind;
                             to.blades = kind.blades;
                             to.rotation_deg = kind.rotation_deg;
                             to.roundness = kind.roundness;
                             to.wavelengths_nm = kind.wavelengths_nm;
                             to.file = kind.file;
                         },
                         fmt::format("What a point out of focus becomes: disc; "
                                     "polygon:BLADES[:DEG[:ROUNDNESS]], 3 to 64 blades, a "
                                     "corner at DEG from the right towards the bottom, roundness 0 to 1; "
                                     "image:FILE, the aperture as a "
                                     "picture; diffraction[:NM[,NM...]]{} [default: disc]",
                                     on_axis ? "" : "; lens:PRESCRIPTION")))
        ->type_name("KIND");
    number(app, "--squeeze", to.squeeze, "The aperture is so many times as tall as wide", "X",
           {.low = 0.1, .high = 10});
    if (!on_axis) {
        number(app, "--cats-eye", to.cats_eye,
               "Mechanical vignetting: a second rim, shifted by X of the lens's radius at the picture's "
               "corner",
               "X", {.low = 0, .high = 1.5});
    }
    number(app, "--spherical", to.spherical,
           "Spherical aberration: the rim of the lens is focused X dioptres nearer than its middle", "X",
           {.low = -10, .high = 10});
}

void exposure_option(CLI::App& app, ExposureOption& to, const std::string& absent) {
    app.add_option_function<std::string>(
           "--exposure",
           [&to](const std::string& text) {
               to = {};
               to.automatic = text == "auto";
               if (to.automatic) return;
               to.stops = parse_number("--exposure", text);
               check_bounds("--exposure", *to.stops, text, exposure_bounds);
           },
           fmt::format(
               "How bright PNG, TIFF and JPEG are: radiance times 2^STOPS, 1 being white, -100 to 100; "
               "auto: 95 % of the lit pixels of a small preview are below white (docs/exposure.md). "
               ".exr stays scene-linear [default: {}]",
               absent))
        ->type_name("STOPS|auto");
}

void lumens_option(CLI::App& app, std::optional<double>& to, const std::string& when) {
    number(app, "--lumens-per-watt", to,
           fmt::format("{}by which the lights of glTF are divided [default: as the sample file was traced]",
                       when),
           "X", lumens_bounds);
}

void scene_options(CLI::App& app, std::string& scene, SceneReadOptions& units, CameraOverrides& camera,
                   std::string& camera_name) {
    reads(app.add_option(
              "scene", scene,
              "Scene: .toml (docs/scene_format.md), .nff, .gltf, .glb, .obj or .ply (docs/mesh_scenes.md)"))
        ->required()
        ->type_name("SCENE");
    number(app, "--metres-per-unit", units.metres_per_unit, "Length of the scene's unit, m", "X", units_m);
    number(app, "--lumens-per-watt", units.lumens_per_watt,
           "By which the lights of glTF, in lux and candela, are divided; 1 takes their numbers as they are",
           "X", lumens_bounds);
    app.add_option_function<std::string>(
           "--size",
           [&camera](const std::string& text) {
               std::tie(camera.width, camera.height) = parse_size("--size", text);
           },
           "Raster, px, 1 to 65536 a side [default: the camera's]")
        ->type_name("WxH");
    app.add_option("--camera", camera_name, "Camera by name [default: the scene's first]")->type_name("NAME");
    number(app, "--film-width", camera.film_width_mm, "Width of the film [default: the camera's]", "MM",
           above_0);
    number(app, "--film-distance", camera.film_distance_mm,
           "From pinhole to film; with the width: the view [default: the camera's]", "MM", above_0);
}

void foreign_channel_options(CLI::App& app, ForeignChoice& to) {
    app.add_option(
           "--layer", to.layer,
           "Of another program's picture: which part, view or layer, by its name [default: docs/inputs.md]")
        ->type_name("NAME");
    app.add_option(
           "--depth-channel", to.depth_channel,
           "Of another program's picture: the channel of the depths [default: Z, Depth.Z and the like]")
        ->type_name("NAME");
    app.add_option_function<std::string>(
           "--depth-encoding",
           [&to](const std::string& text) {
               to.depth_encoding = parse_depth_encoding("--depth-encoding", text);
           },
           "Of another program's picture: what its depths are: distances, one over them, or 0 at NEAR and 1 "
           "at FAR [default: distance]")
        ->type_name("distance|inverse|normalized:NEAR,FAR");
    reads(app.add_option("--depth-file", to.depth_file,
                         "Of another program's picture: where the depths have a file of their own"))
        ->type_name("PICTURE.exr");
    app.add_option(
           "--ids", to.ids,
           "Of another program's picture: the channel or the Cryptomatte of the surfaces' ids [default: a "
           "Cryptomatte, else id, objectId and the like]")
        ->type_name("NAME|none");
    reads(app.add_option("--ids-file", to.ids_file,
                         "Of another program's picture: where the ids have a file of their own"))
        ->type_name("PICTURE.exr");
}

void behind_options(CLI::App& app, ForeignOptions& to) {
    reads(app.add_option(
              "--behind", to.behind,
              "Of another program's picture: a picture of the same camera that stands behind it, with "
              "what the first one hides; may be given again, each behind the one before"))
        ->type_name("PICTURE.exr")
        ->allow_extra_args(false);
    whole(
        app, "--overscan", to.camera.overscan_px,
        "Of another program's picture: how far it shows more than the frame on every side; for a film and a "
        "raster that were made larger; --film-width is the frame's",
        "PX", from_0);
    app.add_option("--behind-layer", to.behind_layer,
                   "--layer of the pictures behind [default: that of --layer]")
        ->type_name("NAME");
}

void object_options(CLI::App& app, ForeignOptions& to) {
    const auto each = [&app](const std::string& name, const std::string& type, const std::string& help,
                             const std::function<void(const std::string&)>& take) {
        reads_of_object(app.add_option_function<std::vector<std::string>>(
                            name,
                            [take](const std::vector<std::string>& texts) {
                                for (const std::string& text : texts) take(text);
                            },
                            help))
            ->type_name(type)
            ->allow_extra_args(false);
    };
    each("--holdout", "OBJECT",
         "Of another program's picture: an object that hides what is behind it, sharply, and is not in the "
         "picture: a name of the Cryptomatte, a number of the id channel, or a picture whose values are its "
         "share of each pixel; may be given again",
         [&to](const std::string& text) {
             to.objects.holdouts.push_back({"--holdout", text});
         });
    each("--keep-sharp", "OBJECT", "An object that is not blurred, likewise", [&to](const std::string& text) {
        to.objects.sharp.push_back({"--keep-sharp", text});
    });
    each("--focus-offset", "OBJECT=M",
         "An object that is blurred as if it were M metres farther away, likewise; M may be negative",
         [&to](const std::string& text) {
             const std::size_t at = text.rfind('=');
             if (at == std::string::npos || at == 0) {
                 fail(ExitCode::wrong_arguments, "--focus-offset: no distance (got {}; expected OBJECT=M)",
                      text);
             }
             to.objects.offsets.push_back({{"--focus-offset", text.substr(0, at)},
                                           parse_number("--focus-offset", text.substr(at + 1))});
         });
    reads_of_object(
        app.add_option_function<std::string>(
            "--matte",
            [&to](const std::string& text) {
                to.matte = ObjectChoice{"--matte", text};
            },
            "The lens has an effect on this object only, likewise; a picture's values say how much"))
        ->type_name("OBJECT");
    app.add_option_function<std::string>(
           "--passes",
           [&to](const std::string& text) {
               for (std::size_t begin = 0; begin <= text.size();) {
                   const std::size_t end = std::min(text.find(',', begin), text.size());
                   const std::string word = text.substr(begin, end - begin);
                   if (word == "coc")
                       to.passes.coc = true;
                   else if (word == "sides")
                       to.passes.sides = true;
                   else if (word == "cryptomatte")
                       to.passes.cryptomatte = true;
                   else if (word == "error")
                       to.passes.error = true;
                   else
                       fail(ExitCode::wrong_arguments,
                            "--passes: unknown (got {}; expected coc, sides, cryptomatte, error, or several "
                            "with commas)",
                            word);
                   begin = end + 1;
               }
           },
           "More channels of the .exr: coc, signed diameter in px; sides, what of a pixel is before, in and "
           "behind the focus; cryptomatte, through the lens; error, of the mean over the views")
        ->type_name("LIST");
}

void foreign_camera_options(CLI::App& app, ForeignCameraChoice& to) {
    number(app, "--film-width", to.film_width_mm,
           "Of another program's picture: width of the film [default: the file's, else 36]", "MM", above_0);
    number(app, "--film-distance", to.film_distance_mm,
           "Of another program's picture: from pinhole to film; with the width: the view [default: the "
           "file's, else "
           "--focal-length, else 50]",
           "MM", above_0);
    app.add_option_function<std::string>(
           "--z",
           [&to](const std::string& text) {
               if (text != "axial" && text != "ray")
                   fail(ExitCode::wrong_arguments, "--z: unknown (got {}; expected axial or ray)", text);
               to.depth_along = text == "ray" ? DepthAlong::ray : DepthAlong::axis;
           },
           "Of another program's picture: depths are along the axis, or from the camera's centre [default: "
           "axial]")
        ->type_name("axial|ray");
}

void tree_options(CLI::App& app, int& max_depth, double& min_contribution) {
    whole(app, "--max-depth", max_depth, "Nodes along a path; the eye ray's is the first", "N",
          {.low = 1, .high = NodePath::max_bounces + 1});
    number(app, "--min-contribution", min_contribution,
           "Subtrees that cannot add this share of white are not traced; 0 traces all", "C", from_0);
}

void shutter_options(CLI::App& app, std::optional<TimeSpan>& shutter, std::string& curve,
                     const std::string& absent) {
    instants(app, "--shutter", shutter,
             fmt::format(
                 "When the shutter opens and closes, s on the scene's clock; OPEN not after CLOSE, equal for "
                 "an instant [default: {}]",
                 absent));
    reads_of_curve(
        app.add_option(
            "--shutter-curve", curve,
            "Transmission while it is open: box, triangle, or a text file of lines \"time transmission\" "
            "[default: box]"))
        ->type_name("box|triangle|FILE");
}

}  // namespace postlens
