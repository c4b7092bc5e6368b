#include "apps/view/view_session.h"

#include <Imath/half.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <tuple>

#include "apps/cli.h"
#include "apps/open_frame.h"
#include "apps/view/image_depths.h"
#include "core/files/scratch_file.h"
#include "core/files/text_file.h"
#include "core/threads.h"

namespace postlens {
namespace {

using Json = nlohmann::ordered_json;

ViewReply error_reply(int status, const std::string& text) {
    return {status, "application/json", Json{{"error", text}}.dump()};
}

void append_bytes(std::string& out, const void* from, std::size_t bytes) {
    out.append(static_cast<const char*>(from), bytes);
}

void append_halves(std::string& out, const std::vector<float>& values) {
    // Values are clamped to the greatest half float, 65504.
    constexpr float greatest = 65504.0F;
    std::vector<std::uint16_t> halves(values.size());
    parallel_for(
        halves.size(),
        [&](std::size_t i) { halves[i] = Imath::half(std::clamp(values[i], -greatest, greatest)).bits(); },
        1U << 16U);
    append_bytes(out, halves.data(), halves.size() * sizeof halves[0]);
}

/// Runs a command that returns its image. The reply has the format of ViewSession::picture.
ViewReply picture_reply(const ParsedCommand& command) {
    const auto start = std::chrono::steady_clock::now();
    const CommandResult result = command.run();
    const Image& image = result.pictures.front();
    Json json = result.json;
    if (json.contains("plan")) {
        // The page only draws the noise of each tile of the light field, so the rest of the plan is not sent.
        Json noise = Json::array();
        for (const Json& tile : json["plan"]["tiles"]) noise.push_back(tile["noise_mse"]);
        json["tiles"] = {
            {"edge_px", json["plan"]["tile_px"]}, {"columns", json["plan"]["columns"]}, {"noise_mse", noise}};
        json.erase("plan");
    }
    json["has_ray_share"] = !result.ray_share.empty();
    json["width"] = image.width;
    json["height"] = image.height;
    json["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    json["warnings"] = Json::array();
    for (const Warning& w : result.warnings) json["warnings"].push_back({{"code", w.code}, {"text", w.text}});
    const std::string text = json.dump();
    ViewReply out{.type = "application/octet-stream"};
    const auto length = static_cast<std::uint32_t>(text.size());
    out.body.reserve(8 + text.size() + 2 * image.rgb.size());
    append_bytes(out.body, &length, sizeof length);
    out.body += text;
    out.body.append((4 - out.body.size() % 4) % 4, '\0');
    append_halves(out.body, image.rgb);
    append_halves(out.body, result.ray_share);
    return out;
}

/// The options of `focus` and `shoot` that the page may set. None of them names a file, so the page cannot
/// access other files.
const std::set<std::string_view>& picture_options() {
    static const std::set<std::string_view> names{
        "f-number", "focus",     "focus-at",   "focal-length",  "framing",         "impulse",   "squeeze",
        "cats-eye", "spherical", "method",     "views",         "depths",          "target-db", "crop",
        "shutter",  "exposure",  "film-width", "film-distance", "metres-per-unit", "z"};
    return names;
}

void check_value(const std::string& name, const std::string& value) {
    constexpr std::size_t longest = 64;
    const bool plain = std::all_of(value.begin(), value.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 ||
               std::string_view("+-.,:_").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (value.size() > longest || !plain) fail(ExitCode::wrong_arguments, "{}: no value of an option", name);
    if (name == "impulse" && (value.starts_with("file") || value.starts_with("lens")))
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

std::string option(const std::string& name, const std::string& value) {
    return "--" + name + "=" + value;
}

}  // namespace

ViewSession::ViewSession(ViewOptions options) : options_(std::move(options)) {
    info_ = run_info({.input = options_.input});
    if (info_.json["kind"] == "samples") {
        kept_ = std::make_shared<KeptFrame>(options_.input, Damage::refuse);
    } else if (info_.json["kind"] != "image") {
        fail(ExitCode::invalid_input, "{}: nothing to view (got a {}; expected a sample file or a picture)",
             options_.input, info_.json["kind"].get<std::string>());
    }
    if (options_.scene) static_cast<void>(run_info({.input = *options_.scene}));
}

ViewReply ViewSession::frame() const {
    Json json = info_.json;
    json.erase("ids");
    json["file"] = options_.input;
    json["name"] = std::filesystem::path(options_.input).filename().string();
    json["scene"] = options_.scene ? Json(*options_.scene) : Json(nullptr);
    json["records_kept"] = kept_ != nullptr;
    return {.body = json.dump()};
}

/// Cancels the current request of the slot, and runs `make` in its place.
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

std::vector<std::string> ViewSession::words_of(const ViewParameters& parameters) const {
    const bool shoots = parameters.contains("shutter");
    std::vector<std::string> words{shoots ? "shoot" : "focus", options_.input};
    bool with_scene = false;
    for (const auto& [name, value] : parameters) {
        if (!picture_options().contains(name)) fail(ExitCode::wrong_arguments, "{:.20}: unknown", name);
        check_value(name, value);
        words.push_back(option(name, value));
        with_scene = with_scene || (name == "method" && (value == "auto" || value == "hybrid"));
    }
    if (with_scene && options_.scene) words.push_back(option("scene", *options_.scene));
    return words;
}

ViewReply ViewSession::picture(const ViewParameters& parameters) {
    return made(pictures_, [&] {
        const ParsedCommand command =
            parse_command_line(words_of(parameters), {.pictures_stay = true, .kept = kept_});
        const auto lock = kept_ ? kept_->lock() : std::unique_lock<std::mutex>();
        throw_if_interrupted();
        return picture_reply(command);
    });
}

ViewReply ViewSession::rays(const ViewParameters& parameters) {
    return made(rays_, [&] {
        if (!options_.scene)
            fail(ExitCode::wrong_arguments, "rays: need the scene (postlens view FRAME SCENE)");
        static const std::set<std::string_view> names{"f-number", "focus",   "focal-length", "framing",
                                                      "impulse",  "squeeze", "cats-eye",     "spherical",
                                                      "shutter",  "spp",     "seed",         "exposure"};
        std::vector<std::string> words{"render", *options_.scene};
        for (const auto& [name, value] : parameters) {
            if (!names.contains(name)) fail(ExitCode::wrong_arguments, "{:.20}: unknown", name);
            check_value(name, value);
            words.push_back(option(name, value));
        }
        // Raster and field of view are those of the frame, even if the camera of the scene differs.
        const Json& frame = info_.json;
        const int width = frame["width"].get<int>();
        words.push_back(option("size", fmt::format("{}x{}", width, frame["height"].get<int>())));
        if (frame.value("projection", "") == "perspective") {
            words.push_back(
                option("film-width", fmt::format("{}", width * frame["pixel_pitch_mm"].get<double>())));
            words.push_back(
                option("film-distance", fmt::format("{}", frame["film_distance_mm"].get<double>())));
        }
        if (!parameters.contains("shutter") && frame.contains("time_s"))
            words.push_back(option("time", fmt::format("{}", frame["time_s"].get<double>())));
        return picture_reply(parse_command_line(words, {.pictures_stay = true}));
    });
}

ViewReply ViewSession::pixel(const ViewParameters& parameters) {
    return made(others_, [&] {
        if (!kept_) fail(ExitCode::wrong_arguments, "a picture of another program has no records");
        RecordsOptions options{.input = options_.input,
                               .at = {number_of(parameters, "x"), number_of(parameters, "y")}};
        if (parameters.contains("f-number")) options.lens.f_number = number_of(parameters, "f-number");
        if (parameters.contains("focus") && parameters.at("focus") != "inf")
            options.lens.focus_m = number_of(parameters, "focus");
        const Json json = run_records(options).json;
        // One visible surface of a pixel: the nodes of all its samples with the same object and path are
        // merged.
        struct Seen {
            double light = 0, inverse_depth = 0;
            const Json* node = nullptr;
        };
        std::map<std::pair<std::string, std::uint32_t>, Seen> seen;
        for (const Json& sample : json["samples"]) {
            for (const Json& node : sample["nodes"]) {
                if (node["layer"] != 0) continue;
                const auto rgb = node["rgb"].get<std::array<double, 3>>();
                const double light = sample["weight"].get<double>() *
                                     std::max(1e-12, 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]);
                Seen& s = seen[{node["path"].get<std::string>(), node["id"].get<std::uint32_t>()}];
                const auto& w = node["w_per_m"];
                const double inverse = w.is_null() ? 0 : (w[0][0].get<double>() + w[1][1].get<double>()) / 2;
                s.light += light;
                s.inverse_depth += light * inverse;
                if (s.node == nullptr) s.node = &node;
            }
        }
        Json out{{"x", json["x"]}, {"y", json["y"]}, {"nodes", Json::array()}};
        std::vector<const Seen*> by_light;
        double all = 0;
        for (const auto& [key, s] : seen) {
            by_light.push_back(&s);
            all += s.light;
        }
        std::stable_sort(by_light.begin(), by_light.end(),
                         [](const Seen* a, const Seen* b) { return a->light > b->light; });
        for (const Seen* s : by_light) {
            const double inverse = s->inverse_depth / s->light;
            Json node = *s->node;
            node.erase("rgb");
            node["share"] = s->light / all;
            // null means infinity. An image behind infinity is also sharpest with the focus at infinity.
            node["focus_m"] = inverse > 0 ? Json(1 / inverse) : Json(nullptr);
            node["behind_infinity"] = inverse < 0;
            out["nodes"].push_back(std::move(node));
        }
        return ViewReply{.body = out.dump()};
    });
}

ViewReply ViewSession::depths() {
    return made(others_, [&] {
        if (!kept_) fail(ExitCode::wrong_arguments, "a picture of another program has no records");
        const ImageDepths depths = image_depths(SampleFileReader(options_.input, Damage::refuse, 0.0));
        ViewReply out{.type = "application/octet-stream"};
        append_bytes(out.body, depths.ids.data(), depths.ids.size() * sizeof depths.ids[0]);
        append_halves(out.body, depths.inverse_per_m);
        return out;
    });
}

ViewReply ViewSession::save(const ViewParameters& parameters) {
    return made(pictures_, [&] {
        ViewParameters asked = parameters;
        const std::string format = asked.contains("format") ? asked["format"] : "";
        asked.erase("format");
        if (format != "png" && format != "exr")
            fail(ExitCode::wrong_arguments, "format: unknown (got {:.20}; expected png or exr)", format);
        const ScratchFile file("picture." + format);
        std::vector<std::string> words = words_of(asked);
        words.push_back("--output=" + file.path().string());
        const ParsedCommand command = parse_command_line(words, {.kept = kept_});
        const auto lock = kept_ ? kept_->lock() : std::unique_lock<std::mutex>();
        static_cast<void>(command.run());
        constexpr std::uintmax_t most_bytes = std::uintmax_t{4} << 30U;
        return ViewReply{.type = format == "png" ? "image/png" : "image/x-exr",
                         .body = read_text_file(file.path(), most_bytes)};
    });
}

void ViewSession::stop() {
    stopped_ = true;
    for (Slot* slot : {&pictures_, &rays_, &others_}) {
        const std::lock_guard lock(slot->mutex);
        if (slot->current) slot->current->cancel();
    }
}

}  // namespace postlens
