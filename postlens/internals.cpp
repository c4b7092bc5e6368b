#include "postlens/internals.h"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <limits>
#include <utility>

#include "core/caught_error.h"
#include "postlens/trace.h"

namespace postlens::api {
namespace {

template <ExitCode code, postlens::ExitCode internal>
constexpr bool same = static_cast<int>(code) == static_cast<int>(internal);
static_assert(same<ExitCode::ok, postlens::ExitCode::ok> &&
              same<ExitCode::comparison_failed, postlens::ExitCode::comparison_failed> &&
              same<ExitCode::wrong_arguments, postlens::ExitCode::wrong_arguments> &&
              same<ExitCode::invalid_input, postlens::ExitCode::invalid_input> &&
              same<ExitCode::cannot_write, postlens::ExitCode::cannot_write> &&
              same<ExitCode::out_of_memory, postlens::ExitCode::out_of_memory> &&
              same<ExitCode::shortfall, postlens::ExitCode::shortfall> &&
              same<ExitCode::interrupted, postlens::ExitCode::interrupted>);

}  // namespace

void rethrow_as_error() {
    try {
        throw;
    } catch (const Error&) {
        throw;
    } catch (...) {
        const postlens::Error e = postlens::caught_error();
        throw Error(static_cast<ExitCode>(e.code()), e.what());
    }
}

std::string Words::text_of(double value) {
    return fmt::format("{}", value);  // the shortest text that is read back as the same bits
}

std::string Words::text_of(const Shutter& shutter) {
    return fmt::format("{}:{}", shutter.open_s, shutter.close_s);
}

void Words::add(const Frame& frame) {
    const auto& f = Internals::frame(frame);
    add_file("frame", f.path);
    add_flag("--salvage", f.salvage);
}

void Words::add_file(const char* what, const std::filesystem::path& path) {
    const std::string text = path.string();
    if (text.empty())
        fail(postlens::ExitCode::wrong_arguments, "{}: no path (got an empty one; expected a file)", what);
    words_.push_back(text.front() == '-' ? "./" + text : text);  // a leading '-' would begin an option
}

void Words::add(const char* option, const std::optional<double>& value) {
    if (value) add(option, text_of(*value));
}

void Words::add(const char* option, const std::optional<int>& value) {
    if (value) add(option, std::to_string(*value));
}

void Words::add_count(const char* option, const std::optional<int>& value) {
    if (value) add(option, *value == automatic ? "auto" : std::to_string(*value));
}

void Words::add(const char* option, const std::optional<std::uint64_t>& value) {
    if (value) add(option, std::to_string(*value));
}

void Words::add(const char* option, const std::string& text) {
    if (!text.empty()) words_.push_back(fmt::format("{}={}", option, text));
}

void Words::add(const char* option, const std::optional<Size>& size) {
    if (size) add(option, fmt::format("{}x{}", size->width, size->height));
}

void Words::add(const char* option, const std::optional<Position>& position) {
    if (position) add(option, fmt::format("{},{}", position->x, position->y));
}

void Words::add(const char* option, const std::optional<Crop>& crop) {
    if (crop) add(option, fmt::format("{},{},{},{}", crop->x, crop->y, crop->width, crop->height));
}

void Words::add(const char* option, const std::optional<Shutter>& shutter) {
    if (shutter) add(option, text_of(*shutter));
}

void Words::add_flag(const char* option, bool given) {
    if (given) words_.emplace_back(option);
}

void Words::add(const LensSettings& lens) {
    add("--focal-length", lens.focal_length_mm);
    add("--f-number", lens.f_number);
    add("--focus", lens.focus_distance_m);
    add("--focus-at", lens.focus_at);
    add("--framing", lens.framing);
    add_flag("--breathing", lens.breathing);
    add("--impulse", lens.impulse);
    add("--squeeze", lens.squeeze);
    add("--cats-eye", lens.cats_eye);
    add("--spherical", lens.spherical);
}

void Words::add(const std::vector<std::string>& options) {
    words_.insert(words_.end(), options.begin(), options.end());
}

double Outcome::number(const char* key) const {
    return number_if_given(key).value_or(0);
}

std::optional<double> Outcome::number_if_given(const char* key) const {
    if (!result.json.contains(key)) return std::nullopt;
    return number_if_known(key).value_or(std::numeric_limits<double>::infinity());
}

std::optional<double> Outcome::number_if_known(const char* key) const {
    if (!result.json.contains(key) || !result.json[key].is_number()) return std::nullopt;
    return result.json[key].get<double>();
}

std::uint64_t Outcome::count(const char* key) const {
    return result.json.value(key, std::uint64_t{0});
}

std::string Outcome::text(const char* key) const {
    return result.json.value(key, std::string());
}

Picture Outcome::take_picture() {
    return result.pictures.empty() ? Picture() : picture_of(std::move(result.pictures.front()));
}

Outcome run_words(const Words& words, const std::shared_ptr<KeptFrame>& kept, bool pictures_stay) {
    Outcome out{.result = run_command(words.words(), {.pictures_stay = pictures_stay, .kept = kept}),
                .report = {}};
    const CommandResult& r = out.result;
    out.report = {.exit_code = static_cast<ExitCode>(r.exit_code),
                  .json = report_json(r),
                  .text = r.text,
                  .warnings = {},
                  .seconds = out.number("seconds")};
    for (const postlens::Warning& w : r.warnings) out.report.warnings.push_back({w.code, w.text, w.share});
    return out;
}

Picture picture_of(Image image) {
    Picture out{.width = image.width,
                .height = image.height,
                .rgb = std::move(image.rgb),
                .alpha = std::move(image.alpha),
                .exposure_stops = image.exposure_stops,
                .planes = {},
                .texts = std::move(image.texts)};
    for (Image::Plane& p : image.planes) out.planes.push_back({std::move(p.name), std::move(p.values)});
    return out;
}

Image image_of(const Picture& picture) {
    const auto pixels = static_cast<std::size_t>(std::max(picture.width, 0)) *
                        static_cast<std::size_t>(std::max(picture.height, 0));
    const auto check = [&](const std::string& name, std::size_t got, std::size_t expected) {
        if (got != expected || pixels == 0) {
            fail(postlens::ExitCode::wrong_arguments,
                 "{}: wrong number of values for {}x{} px (got {}; expected {})", name, picture.width,
                 picture.height, got, expected);
        }
    };
    check("rgb", picture.rgb.size(), 3 * pixels);
    if (!picture.alpha.empty()) check("alpha", picture.alpha.size(), pixels);
    Image out(picture.width, picture.height);
    out.rgb = picture.rgb;
    out.alpha = picture.alpha;
    out.exposure_stops = picture.exposure_stops;
    for (const Plane& p : picture.planes) {
        check(p.name, p.values.size(), pixels);
        out.planes.push_back({p.name, p.values});
    }
    out.texts = picture.texts;
    return out;
}

}  // namespace postlens::api
