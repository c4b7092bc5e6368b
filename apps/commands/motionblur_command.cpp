#include <cmath>
#include <limits>

#include "apps/command.h"
#include "apps/commands/plan_command.h"
#include "apps/deliver.h"
#include "apps/exposure.h"
#include "apps/open_frame.h"
#include "core/counted.h"
#include "motionblur/paths/paths_file.h"
#include "motionblur/vectors/vector_blur.h"
#include "pictures/exposure.h"
#include "sweep/picture_maker.h"

namespace postlens {
namespace {

const char* name(MotionMethod method) {
    switch (method) {
        case MotionMethod::automatic:
            return "auto";
        case MotionMethod::convolve:
            return "convolve";
        case MotionMethod::lightfield:
            return "lightfield";
    }
    return "";
}

// Returns the name of the method that blurred an object, or "none" if the object was not blurred.
const char* used(MotionMethod method) {
    return method == MotionMethod::automatic ? "none" : name(method);
}

const char* name(MotionKind kind) {
    switch (kind) {
        case MotionKind::still:
            return "still";
        case MotionKind::translation:
            return "translation";
        case MotionKind::parallax:
            return "parallax";
        case MotionKind::general:
            return "general";
    }
    return "";
}

nlohmann::ordered_json object_json(const ObjectReport& o) {
    nlohmann::ordered_json out = {{"id", o.id},
                                  {"name", o.name},
                                  {"motion", name(o.kind)},
                                  {"method", used(o.method)},
                                  {"move_px", json_number(o.largest_move_px)},
                                  {"deviation_px", json_number(o.deviation_px)},
                                  {"reason", o.reason}};
    if (o.slices > 0) out["slices"] = o.slices;
    if (o.path_points > 0) out["path_points"] = o.path_points;
    if (o.fitted_knots > 0) {
        out["fitted_knots"] = o.fitted_knots;
        out["fit_error_px"] = o.fit_error_px;
    }
    return out;
}

void refuse_for_pictures(bool given, const char* option, const char* expected = "a sample file") {
    if (!given) return;
    fail(ExitCode::wrong_arguments, "{}: not for a picture with motion vectors (expected {})", option,
         expected);
}

/// Fills in the results that all kinds of input have: the warnings, the exit code and the common JSON keys.
CommandResult report(const MotionBlurOptions& options, const MotionBlurResult& result,
                     std::vector<Warning> warnings = {}) {
    CommandResult out;
    out.warnings = std::move(warnings);
    for (const MotionWarning& w : result.warnings) out.warnings.push_back({w.code, w.text, w.share});
    if (options.strict && !out.warnings.empty()) out.exit_code = ExitCode::shortfall;
    out.json = {{"method", name(result.method)},
                {"views", result.views > 0 ? nlohmann::ordered_json(result.views) : nullptr},
                {"depths", nullptr},
                {"predicted_db", nullptr},
                {"retraced_share", 0.0},
                {"focus_m", nullptr},
                {"focal_length_mm", nullptr},
                {"f_number", nullptr},
                {"touched_share", result.touched_share}};
    return out;
}

/// Returns the first line of the output, for example "a.exr: 960x540 px, convolve, shutter 0 to 0.02 s, 12.5
/// % of the pixels touched".
std::string headline(const MotionBlurOptions& options, const MotionBlurResult& result,
                     const std::string& more) {
    return fmt::format("{}: {}x{} px, {}, {}{}, {:.1f} % of the pixels touched", options.output,
                       result.image.width, result.image.height, name(result.method), more,
                       result.views > 0 ? ", " + counted(result.views, "view") : "",
                       100 * result.touched_share);
}

// Blurs an image made by another program. The image has one sample and one motion vector per pixel.
CommandResult blur_by_vectors(const MotionBlurOptions& options) {
    refuse_for_pictures(options.paths.has_value(), "--paths");
    refuse_for_pictures(options.settings.fit_px.has_value(), "--fit-paths");
    refuse_for_pictures(options.settings.method == MotionMethod::convolve, "--method convolve",
                        "a sample file, or --method lightfield");
    refuse_for_pictures(options.predict, "--predict");
    refuse_for_pictures(options.retrace.scene.has_value(), "--scene");
    refuse_for_pictures(options.target_db.has_value(), "--target-db");
    refuse_for_pictures(options.retrace.explain.has_value(), "--explain");
    refuse_for_pictures(options.retrace.metres_per_unit.has_value(), "--metres-per-unit");
    refuse_for_pictures(options.retrace.lumens_per_watt.has_value(), "--lumens-per-watt");
    if (!options.shutter) {
        fail(ExitCode::wrong_arguments,
             "--shutter: missing (got nothing; expected OPEN:CLOSE in frames, 0 this picture, 1 the next)");
    }
    const Exposure exposure{options.shutter->open_s, options.shutter->close_s};
    VectorFrame frame = read_vector_frame(options.input, options.vectors, options.foreign);
    const double stops = exposure_of_picture(options.exposure, [&] { return frame.picture(); });
    const auto gain = static_cast<float>(exposure_gain(stops));
    for (VectorPixel& p : frame.pixels) {
        for (float& v : p.rgb) v *= gain;
    }
    MotionBlurResult result = vector_blur(frame, {.exposure = exposure,
                                                  .curve = shutter_curve(options.curve),
                                                  .views = options.settings.views,
                                                  .crop = options.settings.crop});
    result.image.exposure_stops = stops;
    std::vector<Warning> warnings;
    warn_of_part(options.input, warnings);
    for (const std::string& text : frame.assumed) warnings.push_back({"assumed", text, 0});
    for (const std::string& problem : frame.problems) warnings.push_back({"ids", problem, 0});
    CommandResult out = report(options, result, std::move(warnings));
    out.json.update({{"shutter_open_frames", exposure.open_s},
                     {"shutter_close_frames", exposure.close_s},
                     {"instants", 1},
                     {"vectors", {frame.u_name, frame.v_name}},
                     {"ids", frame.id_name.empty() ? nlohmann::ordered_json(nullptr)
                                                   : nlohmann::ordered_json(frame.id_name)},
                     {"has_depth", frame.has_z},
                     {"has_alpha", frame.has_alpha},
                     {"longest_vector_px", frame.largest_px},
                     {"objects", nlohmann::ordered_json::array()}});
    out.text =
        headline(options, result,
                 fmt::format("by {} and {}, longest {:.4g} px, shutter {:.6g} to {:.6g} frames", frame.u_name,
                             frame.v_name, frame.largest_px, exposure.open_s, exposure.close_s));
    deliver(std::move(result.image), {options.output, options.settings.crop, options.made_by, options.shared},
            out);
    return out;
}

/// Makes an image with motion blur and with rays that are traced into the scene. The methods of the command
/// `motionblur` trace no rays. Therefore, the options are passed to the command `shoot`, which can trace
/// them.
CommandResult blur_with_rays(const MotionBlurOptions& o) {
    if (!o.retrace.scene)
        fail(ExitCode::wrong_arguments,
             "--target-db, --explain: rays measure the error (expected with --scene)");
    if (o.settings.method == MotionMethod::convolve) {
        fail(ExitCode::wrong_arguments,
             "--scene: not with --method convolve, which has no views (expected auto or lightfield)");
    }
    if (o.settings.fit_px)
        fail(ExitCode::wrong_arguments, "--fit-paths: not with --scene (expected nothing)");
    const bool automatic = o.settings.method == MotionMethod::automatic;
    check_target(o.target_db, automatic ? FocusMethod::automatic : FocusMethod::lightfield);
    if (automatic && o.settings.views) {
        fail(ExitCode::wrong_arguments,
             "--views: not with --scene and the method auto (expected --method lightfield)");
    }
    ShootOptions shoot{.focus = {.shared = o.shared,
                                 .input = o.input,
                                 .output = o.output,
                                 .made_by = o.made_by,
                                 .kept = o.kept,
                                 .method = automatic ? FocusMethod::automatic : FocusMethod::hybrid,
                                 .target_db = o.target_db,
                                 .retrace = o.retrace,
                                 .crop = o.settings.crop,
                                 .exposure = o.exposure,
                                 .predict = o.predict,
                                 .strict = o.strict,
                                 .salvage = o.salvage},
                       .shutter = o.shutter,
                       .curve = o.curve,
                       .paths = o.paths,
                       .shutter_from_frame = o.shutter_from_frame};
    shoot.focus.lens = {.f_number = std::numeric_limits<double>::infinity()};
    // Sets a focus distance if the file has none, because the command `shoot` requires one. The value does
    // not matter: the f-number is infinite, so the lens is a pinhole, whose image does not depend on the
    // focus distance.
    if (!SampleFileReader(o.input, damage_rule(o.salvage)).header().focus_m) shoot.focus.lens.focus_m = 1;
    shoot.focus.views = o.settings.views;
    return run_shoot(shoot);
}

}  // namespace

Exposure resolve_exposure(const std::optional<TimeSpan>& asked, const SampleHeader& header, bool from_frame) {
    const double zero_s = from_frame ? header.time_s : 0;
    if (asked) return {zero_s + asked->open_s, zero_s + asked->close_s};
    if (!header.exposure_s) {
        fail(ExitCode::wrong_arguments,
             "--shutter: missing (got nothing; expected OPEN:CLOSE, as the sample file names no exposure)");
    }
    return {header.time_s, header.time_s + *header.exposure_s};
}

void check_sufficient(const SampleHeader& h, const Exposure& e, std::vector<Warning>& out) {
    const auto &open = h.sufficient.shutter_open_s, &close = h.sufficient.shutter_close_s;
    if (open && close && (e.open_s < *open || e.close_s > *close)) {
        out.push_back(
            {"insufficient", fmt::format("the file was traced for a shutter within {:.6g}:{:.6g} s (got "
                                         "{:.6g}:{:.6g})",
                                         *open, *close, e.open_s, e.close_s)});
    }
}

CommandResult run_motionblur(const MotionBlurOptions& options) {
    check_output(options.output);
    // An image of another program is blurred by motion vectors, in blur_by_vectors. `is_foreign` recognises
    // such an image by its header, which may be damaged. But --salvage is only for damaged sample files, so
    // with this option the file is assumed to be a sample file.
    if (!options.salvage && is_foreign(options.input)) return blur_by_vectors(options);
    const VectorChoice& v = options.vectors;
    // Refuses options that describe the motion, depths and objects of another program's image, because a
    // sample file contains these data itself. A file that is neither such an image nor a sample file is not
    // checked here, because reading it later fails with an error that states the real cause.
    if (SampleFileReader::is_sample_file(options.input)) {
        if (v.channels || v.scale || v.offset || !v.file.empty() || options.foreign.given()) {
            fail(ExitCode::wrong_arguments,
                 "--vectors, --vectors-file, --vector-scale, --vector-offset, --layer, --depth-channel, "
                 "--depth-encoding, --depth-file, --ids, --ids-file: not for a sample file, which knows its "
                 "motion "
                 "(expected a flat OpenEXR picture)");
        }
        check_units(options.retrace);
    }
    if (options.settings.views && options.settings.method == MotionMethod::convolve) {
        fail(ExitCode::wrong_arguments,
             "--views: not with the method convolve (expected auto or lightfield)");
    }
    if (options.settings.fit_px && options.settings.method == MotionMethod::lightfield) {
        fail(ExitCode::wrong_arguments,
             "--fit-paths: not with the method lightfield (expected auto or convolve)");
    }
    if (options.retrace.scene || options.retrace.explain || options.target_db) return blur_with_rays(options);
    MotionBlurSettings settings = options.settings;
    settings.curve = shutter_curve(options.curve);
    if (options.paths) settings.paths = read_paths(*options.paths);
    const Damage damage = damage_rule(options.salvage);
    const auto open = open_frame(options.input, options.kept,
                                 exposure_of_samples(options.exposure, options.input, damage), damage);
    const SampleFileReader& file = open->file;
    settings.exposure = resolve_exposure(options.shutter, file.header(), options.shutter_from_frame);
    const SampleHeader& h = file.header();
    const FocusSettings pinhole{
        .lens = {.focal_length_mm = h.focal_length_mm, .f_number = std::numeric_limits<double>::infinity()},
        .crop = settings.crop};
    if (options.predict) check_predictable(h, pinhole);
    MotionBlurResult result = motion_blur(file, settings);

    std::vector<Warning> warnings;
    warn_of_missing_rows(file, warnings);
    check_sufficient(h, settings.exposure, warnings);
    CommandResult out = report(options, result, std::move(warnings));
    nlohmann::ordered_json objects = nlohmann::ordered_json::array();
    for (const ObjectReport& o : result.objects) objects.push_back(object_json(o));
    out.json.update({{"focus_m", h.focus_m ? json_number(*h.focus_m) : nullptr},
                     {"focal_length_mm", h.focal_length_mm},
                     {"shutter_open_s", settings.exposure.open_s},
                     {"shutter_close_s", settings.exposure.close_s},
                     {"instants", file.instants()},
                     {"objects", objects}});
    out.text = headline(
        options, result,
        fmt::format("shutter {:.6g} to {:.6g} s", settings.exposure.open_s, settings.exposure.close_s));
    if (options.predict) {
        const FrameMotion motion = motion_of(h, settings.paths);
        report_prediction(
            predict_error(open->frame,
                          {.focus = pinhole,
                           .motion = &motion,
                           .shutter = TimeSpan{settings.exposure.open_s, settings.exposure.close_s},
                           .curve = settings.curve},
                          result.image, 0),
            out);
    }
    constexpr std::size_t most_lines = 20;
    std::size_t lines = 0, left = 0;
    for (const ObjectReport& o : result.objects) {
        if (o.kind == MotionKind::still) continue;
        if (lines == most_lines) {
            ++left;
            continue;
        }
        ++lines;
        out.text += fmt::format(
            "\n  {}: {} ({}{})", o.name.empty() ? std::to_string(o.id) : o.name, used(o.method), o.reason,
            o.fitted_knots > 0
                ? fmt::format(", {} fitted by {} within {:.3g} px", counted(o.path_points, "point"),
                              counted(o.fitted_knots, "knot"), o.fit_error_px)
                : "");
    }
    if (left > 0) out.text += fmt::format("\n  and {} more (see --json)", left);
    deliver(std::move(result.image), {options.output, settings.crop, options.made_by, options.shared}, out);
    return out;
}

}  // namespace postlens
