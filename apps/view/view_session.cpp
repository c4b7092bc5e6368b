#include "apps/view/view_session.h"

#include <Imath/half.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string_view>

#include "apps/cli.h"
#include "apps/numbers.h"
#include "apps/open_frame.h"
#include "apps/scene_input.h"
#include "apps/view/error_reference.h"
#include "compare/drawing/cause_picture.h"
#include "core/files/scratch_file.h"
#include "core/files/text_file.h"
#include "core/json_dump.h"
#include "core/threads.h"
#include "lens/impulse.h"
#include "motionblur/paths/paths_file.h"
#include "sweep/picture_maker.h"

namespace postlens {
namespace {

using Json = nlohmann::ordered_json;

ViewReply error_reply(int status, const std::string& text) {
    return {status, "application/json", json_dump(Json{{"error", text}})};
}

void append_bytes(std::string& out, const void* from, std::size_t bytes) {
    out.append(static_cast<const char*>(from), bytes);
}

void append_halves(std::string& out, const std::vector<float>& values) {
    // Values are clamped to 65504, the largest half float.
    constexpr float greatest = 65504.0F;
    std::vector<std::uint16_t> halves(values.size());
    parallel_for(
        halves.size(),
        [&](std::size_t i) { halves[i] = Imath::half(std::clamp(values[i], -greatest, greatest)).bits(); },
        1U << 16U);
    append_bytes(out, halves.data(), halves.size() * sizeof halves[0]);
}

/// Returns the beginning of a reply with binary data: the length of the JSON text, the text, and zeros up to
/// a multiple of 4 bytes. Reserves memory for the `bytes` of data that follow.
ViewReply reply_with(const Json& json, std::size_t bytes) {
    const std::string text = json_dump(json);
    ViewReply out{.type = "application/octet-stream"};
    const auto length = static_cast<std::uint32_t>(text.size());
    out.body.reserve(8 + text.size() + bytes);
    append_bytes(out.body, &length, sizeof length);
    out.body += text;
    out.body.append((4 - out.body.size() % 4) % 4, '\0');
    return out;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Returns the reply to a request for an image: JSON, then the pixels as half floats (ViewSession::picture).
ViewReply picture_reply(const CommandResult& result, double seconds) {
    const Image& image = result.pictures.front();
    Json json = result.json;
    if (json.contains("plan")) {
        // Shortens the JSON for the web page. It contains the plan of the method `auto`, which describes the
        // computation of each tile (square of the image). The page needs only the noise of each tile, as mean
        // squared error.
        Json noise = Json::array();
        for (const Json& tile : json["plan"]["tiles"]) noise.push_back(tile["noise_mse"]);
        json["tiles"] = {
            {"edge_px", json["plan"]["tile_px"]}, {"columns", json["plan"]["columns"]}, {"noise_mse", noise}};
        json.erase("plan");
    }
    json["has_ray_share"] = !result.ray_share.empty();
    json["width"] = image.width;
    json["height"] = image.height;
    json["seconds"] = seconds;
    json["warnings"] = Json::array();
    for (const Warning& w : result.warnings) json["warnings"].push_back({{"code", w.code}, {"text", w.text}});
    ViewReply out = reply_with(json, 2 * image.rgb.size());
    append_halves(out.body, image.rgb);
    append_halves(out.body, result.ray_share);
    return out;
}

/// Runs the command `words` (`focus` or `shoot`) on `kept`, the sample file that the viewer keeps open in
/// memory. Returns the running time of the command in seconds.
double run_kept(const std::vector<std::string>& words, const std::shared_ptr<KeptFrame>& kept,
                CommandResult& result) {
    const ParsedCommand command = parse_command_line(words, {.pictures_stay = true, .kept = kept});
    // Only one request at a time can use the sample file, so this waits until other requests have finished.
    // The wait does not count as running time.
    const auto lock = KeptFrame::lock(kept);
    throw_if_interrupted();
    const auto start = std::chrono::steady_clock::now();
    result = command.run();
    return seconds_since(start);
}

/// The options of the commands `focus` and `shoot` that the viewer's web page may set. None of them names a
/// file, because the page must not access other files.
const std::set<std::string_view>& picture_options() {
    static const std::set<std::string_view> names{
        "f-number", "focus",     "focus-at",   "focal-length",  "framing",         "impulse",   "squeeze",
        "cats-eye", "spherical", "method",     "views",         "depths",          "target-db", "crop",
        "shutter",  "exposure",  "film-width", "film-distance", "metres-per-unit", "z"};
    return names;
}

/// The options that the viewer's web page may set when it requests the causes of an image's errors
/// (ViewSession::causes).
const std::set<std::string_view>& cause_options() {
    static const std::set<std::string_view> names{"f-number", "focus", "focal-length", "impulse",  "shutter",
                                                  "method",   "views", "depths",       "target-db"};
    return names;
}

/// The options of `render` that the page may set.
const std::set<std::string_view>& ray_options() {
    static const std::set<std::string_view> names{"f-number", "focus",   "focal-length", "framing",
                                                  "impulse",  "squeeze", "cats-eye",     "spherical",
                                                  "shutter",  "spp",     "seed",         "exposure"};
    return names;
}

void check_names(const ViewParameters& parameters, const std::set<std::string_view>& known) {
    for (const auto& [name, value] : parameters) {
        if (!known.contains(name)) fail(ExitCode::wrong_arguments, "{:.20}: unknown", name);
    }
}

void check_value(const std::string& name, const std::string& value) {
    constexpr std::size_t longest = 64;
    const bool plain = std::all_of(value.begin(), value.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 ||
               std::string_view("+-.,:_").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (value.size() > longest || !plain) fail(ExitCode::wrong_arguments, "{}: no value of an option", name);
    if (name == "impulse" && !file_of_impulse(value).empty())
        fail(ExitCode::wrong_arguments, "impulse: no file may be read from here (expected disc or polygon)");
}

double number_of(const ViewParameters& parameters, const std::string& name) {
    const auto found = parameters.find(name);
    if (found == parameters.end()) fail(ExitCode::wrong_arguments, "{}: missing", name);
    char* end = nullptr;
    const double value = std::strtod(found->second.c_str(), &end);
    if (found->second.empty() || *end != '\0' || !std::isfinite(value))
        fail(ExitCode::wrong_arguments, "{}: no number (got {:.20})", name, found->second);
    return value;
}

/// Returns the method called `name`, to find the causes of its image's errors. For the method `auto`, returns
/// `hybrid`: `auto` makes its images by the method `hybrid`, so their errors have the same causes. Returns
/// nothing if no method has this name.
std::optional<FocusMethod> method_of(const std::string& name) {
    for (const FocusMethod method : {FocusMethod::scatter, FocusMethod::layers, FocusMethod::lightfield,
                                     FocusMethod::hybrid, FocusMethod::pinhole}) {
        if (name == method_name(method)) return method;
    }
    return name == method_name(FocusMethod::automatic) ? std::optional(FocusMethod::hybrid) : std::nullopt;
}

std::string option(const std::string& name, const std::string& value) {
    return "--" + name + "=" + value;
}

}  // namespace

ViewSession::ViewSession(ViewOptions options)
    : options_(std::move(options)), frame_(open_viewed_frame(options_.input)), facts_(frame_->facts()) {
    if (!options_.scene) return;
    constexpr const char* key = "scene_sha256";
    if (!facts_.contains(key)) {
        fail(ExitCode::wrong_arguments,
             "SCENE: not for a picture of another program, whose scene cannot be traced (got {}; expected "
             "FRAME "
             "only)",
             *options_.scene);
    }
    const Json of_scene = run_info({.input = *options_.scene}).json;
    if (of_scene.at("kind") != "scene") {
        fail(ExitCode::invalid_input, "{}: not a scene (got the kind {}; expected the scene of {})",
             *options_.scene, of_scene["kind"].dump(), options_.input);
    }
    if (facts_[key] != of_scene.at(key)) {
        fail(ExitCode::invalid_input,
             "{}: is not the scene that {} was traced from (got SHA-256 {:.12}...; expected {:.12}...)",
             *options_.scene, options_.input, of_scene[key].get<std::string>(),
             facts_[key].get<std::string>());
    }
}

ViewReply ViewSession::frame() const {
    Json json = facts_;
    json["file"] = options_.input;
    json["name"] = std::filesystem::path(options_.input).filename().string();
    json["scene"] = options_.scene ? Json(*options_.scene) : Json(nullptr);
    json["records_kept"] = frame_->kept() != nullptr;
    return {.body = json_dump(json)};
}

/// Cancels the current request of the slot and runs `make` instead.
ViewReply ViewSession::made(Slot& slot, const std::function<ViewReply()>& make) {
    const auto job = std::make_shared<Job>(JobSettings{.threads = options_.threads});
    {
        const std::lock_guard lock(slot.mutex);
        if (slot.current) slot.current->cancel();
        slot.current = job;
    }
    const std::lock_guard making(slot.making);
    try {
        if (stopped_) job->cancel();
        const JobScope scope(*job);
        throw_if_interrupted();  // a newer request may have cancelled this one while it waited
        return make();
    } catch (const Error& e) {
        return error_reply(e.code() == ExitCode::interrupted ? 409 : 400, e.what());
    } catch (const std::bad_alloc&) {
        return error_reply(400, "not enough memory");
    } catch (const std::exception& e) {
        return error_reply(500, e.what());
    }
}

std::vector<std::string> ViewSession::words_of(const ViewParameters& parameters,
                                               const std::string& input) const {
    const bool shoots = parameters.contains("shutter");
    std::vector<std::string> words{shoots ? "shoot" : "focus", input};
    bool with_scene = false;
    check_names(parameters, picture_options());
    for (const auto& [name, value] : parameters) {
        check_value(name, value);
        words.push_back(option(name, value));
        with_scene = with_scene || (name == "method" && (value == "auto" || value == "hybrid"));
    }
    if (with_scene && options_.scene) words.push_back(option("scene", *options_.scene));
    return words;
}

std::vector<std::string> ViewSession::ray_words_of(const ViewParameters& parameters) const {
    if (!options_.scene) fail(ExitCode::wrong_arguments, "rays: need the scene (postlens view FRAME SCENE)");
    std::vector<std::string> words{"render", *options_.scene};
    for (const auto& [name, value] : parameters) {
        if (!ray_options().contains(name)) continue;
        check_value(name, value);
        words.push_back(option(name, value));
    }
    // The ray-traced image gets the size, the field of view and the exposure of the sample file's image, so
    // that the images can be compared.
    const int width = facts_["width"].get<int>();
    words.push_back(option("size", fmt::format("{}x{}", width, facts_["height"].get<int>())));
    const auto add = [&](const char* name, double value) {
        words.push_back(option(name, fmt::format("{}", value)));
    };
    const auto add_fact = [&](const char* name, const char* fact) {
        const bool known = facts_.contains(fact) && !facts_[fact].is_null();
        if (known && !parameters.contains(name)) add(name, facts_[fact].get<double>());
    };
    if (facts_.value("projection", "") == "perspective") {
        add("film-width", width * facts_["pixel_pitch_mm"].get<double>());
        add("film-distance", facts_["film_distance_mm"].get<double>());
    }
    add_fact("exposure", "exposure_stops");
    add_fact("lumens-per-watt", "lumens_per_watt");
    add_fact("metres-per-unit", "metres_per_unit");
    if (!parameters.contains("shutter")) add_fact("time", "time_s");
    return words;
}

ViewReply ViewSession::picture(const ViewParameters& parameters) {
    return made(pictures_, [&] {
        const std::vector<std::string> words = words_of(parameters, options_.input);
        CommandResult result;
        const double seconds = run_kept(words, frame_->kept(), result);
        ViewReply reply = picture_reply(result, seconds);
        const auto last = std::make_shared<const MadeImage>(
            MadeImage{words, std::move(result.pictures.front()), result.json.value("method", "")});
        const std::lock_guard guard(last_mutex_);
        last_ = last;
        return reply;
    });
}

ViewReply ViewSession::coarse_picture(const ViewParameters& parameters) {
    return made(pictures_, [&] {
        for (const char* name : {"crop", "focus-at"}) {
            if (parameters.contains(name))
                fail(ExitCode::wrong_arguments, "{}: not for a coarse picture", name);
        }
        const auto [input, kept, by] = frame_->coarse();
        CommandResult result;
        const double seconds = run_kept(words_of(parameters, input), kept, result);
        result.json["by"] = by;
        return picture_reply(result, seconds);
    });
}

ViewReply ViewSession::rays(const ViewParameters& parameters) {
    return made(rays_, [&] {
        check_names(parameters, ray_options());
        const ParsedCommand command = parse_command_line(ray_words_of(parameters), {.pictures_stay = true});
        const auto start = std::chrono::steady_clock::now();
        const CommandResult result = command.run();
        return picture_reply(result, seconds_since(start));
    });
}

ViewReply ViewSession::pixel(const ViewParameters& parameters) {
    return made(pixels_, [&] {
        LensOptions lens;
        if (parameters.contains("f-number")) lens.f_number = number_of(parameters, "f-number");
        if (parameters.contains("focal-length")) lens.focal_length_mm = number_of(parameters, "focal-length");
        if (parameters.contains("focus")) {
            lens.focus_m = parameters.at("focus") == "inf" ? std::numeric_limits<double>::infinity()
                                                           : number_of(parameters, "focus");
        }
        return ViewReply{
            .body = json_dump(frame_->pixel(number_of(parameters, "x"), number_of(parameters, "y"), lens))};
    });
}

ViewReply ViewSession::depths() {
    return made(depths_, [&] {
        const ImageDepths depths = frame_->depths();
        ViewReply out{.type = "application/octet-stream"};
        append_bytes(out.body, depths.ids.data(), depths.ids.size() * sizeof depths.ids[0]);
        append_halves(out.body, depths.inverse_per_m);
        return out;
    });
}

/// Returns the image for these parameters. If they are the same as those of the last image, returns that
/// image. Otherwise, makes the image by a command that opens the file once more, so that the viewer's own
/// open file stays free for other requests.
std::shared_ptr<const ViewSession::MadeImage> ViewSession::image_of(const ViewParameters& parameters) {
    const std::vector<std::string> words = words_of(parameters, options_.input);
    const ParsedCommand command = parse_command_line(words, {.pictures_stay = true});
    {
        const std::lock_guard guard(last_mutex_);
        if (last_ && last_->words == words) return last_;
    }
    CommandResult result = command.run();
    return std::make_shared<const MadeImage>(
        MadeImage{words, std::move(result.pictures.front()), result.json.value("method", "")});
}

ViewReply ViewSession::causes(const ViewParameters& parameters) {
    return made(causes_, [&] {
        const auto start = std::chrono::steady_clock::now();
        check_names(parameters, cause_options());
        if (!options_.scene || !frame_->kept())
            fail(ExitCode::wrong_arguments,
                 "causes: need records and the scene that they were traced from (postlens view FRAME SCENE)");
        const auto image = image_of(parameters);
        ErrorReference reference = trace_error_reference([&](int spp) {
            std::vector<std::string> words = ray_words_of(parameters);
            words.push_back(option("spp", fmt::format("{}", spp)));
            words.emplace_back("--halves");
            CommandResult result = parse_command_line(words, {.pictures_stay = true}).run();
            std::vector<Image>& p = result.pictures;
            return HalvedImage{std::move(p.at(0)), std::move(p.at(1)), std::move(p.at(2)),
                               result.json["seconds_render"].get<double>()};
        });
        take_out_noise(reference, image->image);
        const CauseMap map = causes_of(parameters, *image, reference.image);
        Json json{{"width", map.width},
                  {"height", map.height},
                  {"spp", reference.spp},
                  {"seconds", seconds_since(start)},
                  {"causes", Json::array()}};
        for (std::size_t c = 0; c < error_causes; ++c) {
            const auto cause = static_cast<ErrorCause>(c);
            json["causes"].push_back({{"name", cause_name(cause)},
                                      {"colour", cause_colour(cause)},
                                      {"error_share", map.error_share[c]}});
        }
        ViewReply out = reply_with(json, map.causes.size());
        append_bytes(out.body, map.causes.data(), map.causes.size());
        return out;
    });
}

CauseMap ViewSession::causes_of(const ViewParameters& parameters, const MadeImage& made,
                                const Image& reference) const {
    const SampleFileReader file(options_.input, Damage::refuse, std::nullopt);
    const auto text_of = [&](const char* name) {
        const auto found = parameters.find(name);
        return found == parameters.end() ? std::optional<std::string>() : found->second;
    };
    LensOptions lens;
    const auto take = [&](std::optional<double>& to, const char* name, bool infinite) {
        if (const auto text = text_of(name)) to = parse_number(name, *text, infinite);
    };
    take(lens.f_number, "f-number", true);
    take(lens.focus_m, "focus", true);
    take(lens.focal_length_mm, "focal-length", false);
    const ResolvedLens resolved = resolve_lens(lens, file);
    const FrameMotion motion = motion_of(file.header(), {});
    CommandResult warnings;
    const Scene scene = read_scene_of_file(*options_.scene, std::nullopt, std::nullopt, file, {}, warnings);
    CauseRequest request;
    request.view.focus.lens = resolved.lens;
    request.view.focus.focus_distance_m = resolved.focus_m;
    if (const auto text = text_of("impulse")) request.view.focus.impulse = parse_impulse("impulse", *text);
    request.view.motion = &motion;
    request.view.scene = &scene;
    if (const auto text = text_of("shutter")) {
        const auto [open, close] = parse_span("shutter", *text);
        request.view.shutter = TimeSpan{open, close};
    }
    request.method = method_of(made.method);
    if (const auto text = text_of("depths")) request.depths = parse_whole("depths", *text);
    FocusFrame frame(file);
    return find_error_causes(frame, made.image, reference, request);
}

ViewReply ViewSession::drop_causes() {
    const std::lock_guard lock(causes_.mutex);
    if (causes_.current) causes_.current->cancel();
    return {.body = "{}"};
}

ViewReply ViewSession::save(const ViewParameters& parameters) {
    return made(pictures_, [&] {
        ViewParameters asked = parameters;
        const std::string format = asked.contains("format") ? asked["format"] : "";
        asked.erase("format");
        if (format != "png" && format != "exr")
            fail(ExitCode::wrong_arguments, "format: unknown (got {:.20}; expected png or exr)", format);
        const ScratchFile file("picture." + format);
        std::vector<std::string> words = words_of(asked, options_.input);
        words.push_back("--output=" + file.path().string());
        const std::shared_ptr<KeptFrame> kept = frame_->kept();
        const ParsedCommand command = parse_command_line(words, {.kept = kept});
        const auto lock = KeptFrame::lock(kept);
        static_cast<void>(command.run());
        constexpr std::uintmax_t most_bytes = std::uintmax_t{4} << 30U;
        return ViewReply{.type = format == "png" ? "image/png" : "image/x-exr",
                         .body = read_text_file(file.path(), most_bytes)};
    });
}

void ViewSession::stop() {
    stopped_ = true;
    for (Slot* slot : {&pictures_, &rays_, &pixels_, &depths_, &causes_}) {
        const std::lock_guard lock(slot->mutex);
        if (slot->current) slot->current->cancel();
    }
}

}  // namespace postlens
