#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>

#include "apps/command.h"
#include "apps/deliver.h"
#include "apps/exposure.h"
#include "apps/numbers.h"
#include "core/counted.h"
#include "core/text.h"
#include "focus/foreign_focus.h"
#include "focus/usual_method.h"
#include "pictures/crop.h"
#include "pictures/stacks/lay_behind.h"
#include "pictures/stacks/unmix_edges.h"
#include "sweep/picture_maker.h"

namespace postlens {
namespace {

void add_warnings(const ForeignPicture& picture, bool with_camera, std::vector<Warning>& out) {
    for (const ForeignRepair& r : picture.repairs) out.push_back({r.code, r.text, r.share});
    if (!with_camera) return;
    for (const std::string& text : picture.camera.assumed) out.push_back({"assumed", text, 0});
}

nlohmann::ordered_json channels_json(const ForeignChannels& c) {
    nlohmann::ordered_json out = nlohmann::ordered_json::object();
    const auto add = [&](const char* key, const std::string& name) {
        out[key] = name.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(name);
    };
    add("red", c.r);
    add("green", c.g);
    add("blue", c.b);
    add("chroma_red", c.ry);
    add("chroma_blue", c.by);
    add("alpha", c.a);
    add("depth", c.z);
    add("depth_back", c.z_back);
    add("id", c.id);
    add("cryptomatte", c.matte ? c.matte->name : "");
    return out;
}

/// Adds further images, named by the option --behind, to the image `picture`. Each image shows what is hidden
/// behind the images before it, so it is composited behind them.
void lay_all_behind(ForeignPicture& picture, const ForeignOptions& options, const ForeignCameraChoice& camera,
                    std::size_t& unmixed) {
    ForeignChoice choice = options.choice;
    choice.depth_file.clear();
    choice.ids_file.clear();
    if (!options.behind_layer.empty()) {
        if (options.behind.empty()) {
            fail(ExitCode::wrong_arguments,
                 "--behind-layer: of which picture? (got {}; expected --behind with it)",
                 options.behind_layer);
        }
        choice.layer = options.behind_layer;
    }
    for (const std::string& name : options.behind) {
        ForeignPicture back = read_foreign_picture(name, choice, camera);
        // A pixel at an edge mixes the colours of surfaces at different depths. It is split into one sample
        // per surface, so that these can be composited separately.
        unmixed += unmix_edges(back);
        const LaidBehind laid = lay_behind(picture, back, name);
        for (ForeignRepair& r : back.repairs) {
            r.text = name + ": " + r.text;
            picture.repairs.push_back(std::move(r));
        }
        if (laid.nearer_share > 0) {
            picture.repairs.push_back(
                {"behind",
                 fmt::format(
                     "{}: {} % of its pixels are nearer than the picture that it is to lie behind: left out",
                     name, rough(100 * laid.nearer_share)),
                 laid.nearer_share});
        }
    }
}

/// Blends the pinhole image (matte 0) and the blurred image (matte 1).
void limit_to(const std::vector<float>& matte, const Image& pinhole, Image& image) {
    for (std::size_t i = 0; i < matte.size(); ++i) {
        const auto mix = [&](float from, float to) { return from + matte[i] * (to - from); };
        for (std::size_t c = 0; c < 3; ++c)
            image.rgb[3 * i + c] = mix(pinhole.rgb[3 * i + c], image.rgb[3 * i + c]);
        if (!image.alpha.empty())
            image.alpha[i] = mix(pinhole.alpha.empty() ? 1.0F : pinhole.alpha[i], image.alpha[i]);
    }
}

void check_passes(const FocusOptions& options) {
    if (!options.foreign.passes.any() || options.output.empty()) return;
    check_exr_path(options.output, "passes");
}

/// Multiplies the colours by the exposure of the option --exposure. Returns this exposure in stops.
double expose(ForeignPicture& picture, const ExposureOption& asked) {
    const double stops = exposure_of_picture(asked, [&] { return picture.flattened(); });
    if (stops == 0) return 0;
    const auto gain = static_cast<float>(exposure_gain(stops));
    for (StackSample& s : picture.samples) s.r *= gain, s.g *= gain, s.b *= gain;
    return stops;
}

/// Returns the JSON that `info` reports for one part of an OpenEXR file.
nlohmann::ordered_json part_json(const ForeignPart& part) {
    return {{"name", part.name},
            {"view", part.view},
            {"deep", part.deep},
            {"width", part.width()},
            {"height", part.height()},
            {"channels", part.channels},
            {"layers", colour_layers(part)}};
}

}  // namespace

std::vector<std::string*> ForeignOptions::files() {
    std::vector<std::string*> out;
    for (std::string& name : behind) out.push_back(&name);
    const auto add = [&](ObjectChoice& o) {
        if (o.is_file()) out.push_back(&o.object);
    };
    for (ObjectChoice& o : objects.holdouts) add(o);
    for (ObjectChoice& o : objects.sharp) add(o);
    for (ObjectEffects::Offset& o : objects.offsets) add(o.object);
    if (matte) add(*matte);
    return out;
}

bool is_foreign(const std::string& input) {
    return is_openexr(input) && !SampleFileReader::is_sample_file(input);
}

std::string ForeignOptions::given() const {
    std::string names;
    for (const auto& [name, is_given] : std::initializer_list<std::pair<const char*, bool>>{
             {"--behind", !behind.empty()},
             {"--behind-layer", !behind_layer.empty()},
             {"--holdout", !objects.holdouts.empty()},
             {"--keep-sharp", !objects.sharp.empty()},
             {"--focus-offset", !objects.offsets.empty()},
             {"--matte", matte.has_value()},
             {"--passes", passes.any()},
             {"--layer", !choice.layer.empty()},
             {"--depth-channel", !choice.depth_channel.empty()},
             {"--depth-encoding", choice.depth_encoding.has_value()},
             {"--depth-file", !choice.depth_file.empty()},
             {"--ids", !choice.ids.empty()},
             {"--ids-file", !choice.ids_file.empty()},
             {"--film-width", camera.film_width_mm.has_value()},
             {"--film-distance", camera.film_distance_mm.has_value()},
             {"--z", camera.depth_along.has_value()},
             {"--overscan", camera.overscan_px != 0}}) {
        if (is_given) names += (names.empty() ? "" : ", ") + std::string(name);
    }
    return names;
}

void refuse_foreign_options(const ForeignOptions& options, const std::string& input) {
    const std::string given = options.given();
    if (given.empty() || !SampleFileReader::is_sample_file(input)) return;
    fail(ExitCode::wrong_arguments,
         "{}: not for a sample file, which knows its camera (expected an OpenEXR picture of another program)",
         given);
}

CommandResult foreign_image(const ImageOptions& options) {
    ForeignChoice choice = options.foreign.choice;
    if (choice.ids.empty()) choice.ids = ForeignChoice::no_ids;  // flattening needs no ids
    ForeignPicture picture = read_foreign_picture(options.input, choice, options.foreign.camera);
    check_crop(options.crop, picture.width, picture.height);
    const double stops = expose(picture, options.exposure);
    Image image = picture.flattened();
    image.exposure_stops = stops;
    CommandResult out;
    warn_of_part(options.input, out.warnings);
    add_warnings(picture, false, out.warnings);
    const int width = options.crop ? options.crop->width : image.width,
              height = options.crop ? options.crop->height : image.height;
    out.json = {{"width", width},
                {"height", height},
                {"records", picture.samples.size()},
                {"has_alpha", !image.alpha.empty()},
                {"channels", channels_json(picture.channels)}};
    out.text = fmt::format("{}: {}x{} px, flattened", options.output, width, height);
    deliver(std::move(image), {options.output, options.crop, options.made_by, {}}, out);
    return out;
}

CommandResult focus_foreign(const FocusOptions& options) {
    if (options.predict) {
        fail(ExitCode::wrong_arguments,
             "--predict: not for a picture of another program, which does not tell what it lacks (expected a "
             "sample file)");
    }
    for (const auto& [name, is_given] : std::initializer_list<std::pair<const char*, bool>>{
             {"--scene", options.retrace.scene.has_value()},
             {"--target-db", options.target_db.has_value()},
             {"--explain", options.retrace.explain.has_value()}}) {
        if (is_given) {
            fail(ExitCode::wrong_arguments,
                 "{}: not for a picture of another program, whose scene cannot be traced (expected a sample "
                 "file)",
                 name);
        }
    }
    for (const auto& [name, is_given] : std::initializer_list<std::pair<const char*, bool>>{
             {"--lumens-per-watt", options.retrace.lumens_per_watt.has_value()},
             {"--depth-model", options.depth_model != DepthModel::ray_differentials}}) {
        if (!is_given) continue;
        fail(ExitCode::wrong_arguments, "{}: not for a picture of another program (expected a sample file)",
             name);
    }
    check_passes(options);
    LensOptions lens = options.lens;
    CommandResult out;
    if (options.impulse.kind == ImpulseKind::lens)
        take_from_prescription(options.impulse, lens, out.warnings);
    ForeignCameraChoice choice = options.foreign.camera;
    // Sets the focal length of the camera that rendered the image, in mm. The user can state it, in `lens`.
    // But if the impulse response comes from a lens prescription (ImpulseKind::lens), `lens` contains the
    // focal length of the prescription, not that of the camera, so it is not used here.
    if (options.impulse.kind != ImpulseKind::lens) choice.focal_length_mm = lens.focal_length_mm;
    choice.metres_per_unit = options.retrace.metres_per_unit;
    const bool pinhole = options.method == FocusMethod::pinhole;
    ForeignPicture picture = read_foreign_picture(options.input, options.foreign.choice, choice);
    std::size_t unmixed = pinhole && !options.foreign.stacks() ? 0 : unmix_edges(picture);
    lay_all_behind(picture, options.foreign, choice, unmixed);
    const double stops = expose(picture, options.exposure);
    const bool unplanned = options.takes_usual_method();
    const UsualMethod usual = usual_method_of_foreign_picture();
    const FocusMethod method = unplanned ? usual.method : options.method;
    // Checks that the options suit the method. The option --views states the number of views (images seen
    // from single lens points), so it is refused if the method makes no views.
    check_depth_options(options.spacing, options.depth_model, method);
    // Some extra output channels (`by_views`) are averages over views, with every method. If they are wanted,
    // --views is not checked.
    check_counts(options.depths, options.foreign.passes.by_views() ? std::nullopt : options.views, method);
    check_crop(options.crop, picture.width, picture.height);
    const double f_number =
        pinhole ? std::numeric_limits<double>::infinity()
                : asked_or_named(lens.f_number, picture.camera.f_number, "--f-number", "picture");
    const double focus_m = lens.focus_at ? picture.depth_at(lens.focus_at->first, lens.focus_at->second)
                           : pinhole
                               ? lens.focus_m.value_or(1)
                               : asked_or_named(lens.focus_m, picture.camera.focus_m, "--focus", "picture");
    const double focal_length_mm = lens.focal_length_mm.value_or(picture.camera.focal_length_mm);
    apply_object_effects(picture, options.foreign.objects, 1 / focus_m);
    FocusSettings settings{.lens = {.focal_length_mm = focal_length_mm, .f_number = f_number},
                           .focus_distance_m = focus_m,
                           .framing = lens.framing,
                           .method = method,
                           .spacing = options.spacing,
                           .depth_model = options.depth_model,
                           .impulse = options.impulse,
                           .depths = options.depths,
                           .views = options.views.value_or(default_lens_views),
                           .crop = options.crop};
    FocusResult result = focus_foreign(picture, settings);
    std::vector<float> effect;
    if (options.foreign.matte) {
        if (lens.framing != Framing::keep) {
            fail(ExitCode::wrong_arguments,
                 "--matte: not for a picture that the lens crops or magnifies (expected --framing keep)");
        }
        settings.method = FocusMethod::pinhole;
        effect = choose_pixels(picture, *options.foreign.matte);
        limit_to(effect, focus_foreign(picture, settings).image, result.image);
        settings.method = method;
    }
    const double beyond_ranks =
        add_focus_passes(picture, settings, options.foreign.passes, result.image, effect);
    result.image.exposure_stops = stops;
    warn_of_part(options.input, out.warnings);
    for (const std::string& behind : options.foreign.behind) warn_of_part(behind, out.warnings);
    add_warnings(picture, true, out.warnings);
    for (const FocusWarning& w : result.warnings) out.warnings.push_back({w.code, w.text, w.share});
    if (beyond_ranks > 0) {
        out.warnings.push_back({"ids",
                                fmt::format("{} % of the pixels show more objects than the Cryptomatte has "
                                            "ranks: the smallest coverages are left out (expected a picture "
                                            "whose Cryptomatte has more ranks)",
                                            rough(100 * beyond_ranks)),
                                beyond_ranks});
    }
    if (options.strict && !out.warnings.empty()) out.exit_code = ExitCode::shortfall;
    const bool told = unplanned && result.method == method;
    out.json = {{"method", method_name(result.method)},
                {"method_reason", told ? nlohmann::ordered_json(usual.reason) : nullptr},
                {"views", result.views > 0 ? nlohmann::ordered_json(result.views) : nullptr},
                {"depths", result.depths},
                {"predicted_db", nullptr},
                {"retraced_share", 0.0},
                {"focus_m", json_number(focus_m)},
                {"focal_length_mm", focal_length_mm},
                {"f_number", json_number(f_number)},
                {"impulse", impulse_text(options.impulse)},
                {"largest_coc_px", json_number(result.largest_coc_px)},
                {"film_width_mm", picture.camera.film_width_mm},
                {"film_distance_mm", picture.camera.film_distance_mm},
                {"metres_per_unit", picture.camera.metres_per_unit},
                {"z", picture.camera.depth_along == DepthAlong::ray ? "ray" : "axial"},
                {"samples", picture.samples.size()},
                {"behind", options.foreign.behind},
                {"unmixed", unmixed},
                {"has_alpha", !result.image.alpha.empty()},
                {"channels", channels_json(picture.channels)}};
    out.text = fmt::format("{}: {}x{} px, {}, F = {:.4g} mm, f/{:.4g}, focus {:.4g} m, {}, widest CoC {}",
                           options.output, result.image.width, result.image.height,
                           method_name(result.method), focal_length_mm, f_number, focus_m,
                           result.views > 0 ? counted(result.views, "view") : counted(result.depths, "depth"),
                           px_text(result.largest_coc_px));
    if (told) out.text += fmt::format("\n  {}, {}", method_name(method), usual.reason);
    deliver(std::move(result.image), {options.output, options.crop, options.made_by, options.shared}, out);
    return out;
}

CommandResult foreign_info(const std::string& input) {
    const ForeignFile file(input);
    const ForeignPart& first = file.parts()[0];
    CommandResult out;
    nlohmann::ordered_json parts = nlohmann::ordered_json::array();
    for (const ForeignPart& part : file.parts()) parts.push_back(part_json(part));
    out.json = {{"kind", "image"},
                {"width", first.display.x_max - first.display.x_min + 1},
                {"height", first.display.y_max - first.display.y_min + 1},
                {"format", "openexr"},
                {"channels", first.channels},
                {"deep", first.deep},
                {"parts", parts}};
    out.text = fmt::format("{}: openexr image, {}x{} px, {}{}{}", input,
                           first.display.x_max - first.display.x_min + 1,
                           first.display.y_max - first.display.y_min + 1,
                           counted(first.channels.size(), "channel"), first.deep ? ", deep" : "",
                           file.parts().size() > 1 ? fmt::format(", {} parts", file.parts().size()) : "");
    warn_of_part(input, out.warnings);
    ForeignChannels channels;
    try {
        channels = find_foreign_channels(file, {});
    } catch (const Error&) {
        return out;  // an image without colour channels is valid too
    }
    const ForeignCamera camera = foreign_camera(file, channels.part, {});
    out.json["colour"] = channels_json(channels);
    out.json["focal_length_mm"] = camera.focal_length_mm;
    out.json["film_distance_mm"] = camera.film_distance_mm;
    out.json["film_width_mm"] = camera.film_width_mm;
    out.json["assumed"] = camera.assumed;
    nlohmann::ordered_json mattes = nlohmann::ordered_json::array();
    const Cryptomattes found =
        file.parts()[channels.part].deep ? Cryptomattes() : find_cryptomattes(file, channels.part);
    std::string ids;
    for (const Cryptomatte& m : found.usable) {
        const std::optional<std::vector<std::string>> names =
            m.manifest.empty() ? std::vector<std::string>() : manifest_names(m.manifest);
        mattes.push_back({{"name", m.name},
                          {"ranks", m.ranks.size()},
                          {"names", names ? nlohmann::ordered_json(names->size()) : nullptr}});
        ids += fmt::format("\nCryptomatte {}, {}, {}", m.name, counted(m.ranks.size(), "rank"),
                           names ? counted(names->size(), "name") : "a manifest that is damaged");
    }
    for (const std::string& problem : found.problems) out.warnings.push_back({"ids", problem, 0});
    for (const std::string& text : channels.assumed) out.warnings.push_back({"assumed", text, 0});
    out.json["cryptomattes"] = mattes;
    if (!channels.id.empty()) ids += "\nids " + channels.id;
    out.text +=
        fmt::format("\ncolour {}, alpha {}, depth {}\nfilm {:.5g} mm wide, {:.5g} mm away",
                    channels.r.empty() ? std::string("none")
                                       : fmt::format("{}, {}, {}", channels.r, channels.g, channels.b),
                    channels.a.empty() ? "none" : channels.a, channels.z.empty() ? "none" : channels.z,
                    camera.film_width_mm, camera.film_distance_mm);
    out.text += ids;
    for (const std::string& text : camera.assumed) out.text += "\n" + text;
    return out;
}

}  // namespace postlens
