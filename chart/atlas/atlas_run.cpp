#include "chart/atlas/atlas_run.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "chart/atlas/atlas_picture.h"
#include "chart/chart_plan.h"
#include "compare/drawing/error_map.h"
#include "core/error.h"
#include "motionblur/paths/paths_file.h"
#include "planner/error_causes.h"
#include "scene/file_digest.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int gap_px = 4;
// Smallest allowed channel value. Rounding may make a 0 slightly negative.
constexpr double least_allowed = -1e-5;

double sum_of(const Image& image) {
    double out = 0;
    for (const float v : image.rgb) out += std::isfinite(v) ? static_cast<double>(v) : 0;
    return out;
}

class CaseRun {
  public:
    CaseRun(const AtlasCase& c, fs::path folder)
        : case_(c),
          folder_(std::move(folder)),
          scene_(read_scene(c.view.scene)),
          view_(chart_view(c.view, scene_)) {}

    AtlasResult run(const fs::path& strip) {
        AtlasResult out;
        out.key = atlas_key(case_);
        RenderSettings s = render_settings(case_.view, view_);
        s.spp = 2 * case_.view.reference_spp;
        s.halves = true;
        s.seed = reference_seed;
        RenderResult reference = render_picture(scene_, s);
        halves_ = std::move(reference.halves);
        const AtlasPicture picture = make(case_.method);
        pinhole_ = pinhole_picture(SampleFileReader(traced(case_.method.trace)));
        out.method = figures(picture, &out);
        if (case_.cause != "none") name_causes(picture.image, reference.image, out);
        std::optional<AtlasPicture> better;
        if (case_.remedy) {
            better = make(*case_.remedy);
            out.remedy = figures(*better, nullptr);
        }
        if (!strip.empty()) {
            std::vector<const Image*> cells{&picture.image};
            if (better) cells.push_back(&better->image);
            cells.push_back(&reference.image);
            const Image map = error_map(picture.image, reference.image);
            cells.push_back(&map);
            write_image(strip, beside_each_other(cells));
        }
        if (!trace_path_.empty()) fs::remove(trace_path_);
        return out;
    }

  private:
    // Traces the scene with the settings `trace`, and returns the sample file. If the last sample file has
    // equal settings, it is returned instead: a test case often compares two methods with the same file.
    const fs::path& traced(const AtlasTrace& trace) {
        if (trace_path_.empty() || !(trace == trace_)) {
            if (!trace_path_.empty()) fs::remove(trace_path_);
            trace_path_ = folder_ / (case_.name + ".exr");
            trace_ = trace;
            (void)trace_to_file(scene_, atlas_trace_settings(trace, case_.view, view_), trace_path_);
        }
        return trace_path_;
    }

    AtlasPicture make(const AtlasMethod& method) {
        return atlas_picture(method, case_.view, view_, scene_,
                             method.name == "rays" ? fs::path() : traced(method.trace));
    }

    AtlasFigures figures(const AtlasPicture& p, AtlasResult* about) const {
        AtlasFigures out;
        const Comparison c = compare_pictures(
            {.image = p.image, .reference = halves_[0], .pinhole = pinhole_, .second_reference = halves_[1]});
        out.error = chart_error(c.whole.errors, c.noise);
        if (c.affected) out.affected = chart_error(c.affected->errors, c.affected_noise);
        out.energy = 2 * sum_of(p.image) / (sum_of(halves_[0]) + sum_of(halves_[1]));
        out.least_value = std::numeric_limits<double>::infinity();
        for (const float v : p.image.rgb) {
            if (std::isfinite(v)) out.least_value = std::min(out.least_value, static_cast<double>(v));
        }
        out.nonfinite = c.nonfinite.image;
        out.warnings = p.warnings;
        out.retraced_share = p.retraced_share;
        if (about != nullptr) {
            about->pinhole_db = c.pinhole ? c.pinhole->psnr_db : std::nan("");
            about->affected_share = c.affected_share.value_or(0);
            about->noise_db = c.noise ? -10 * std::log10(c.noise->reference_mse) : std::nan("");
        }
        return out;
    }

    void name_causes(const Image& image, const Image& reference, AtlasResult& out) {
        const SampleFileReader file(traced(case_.method.trace));
        const FrameMotion motion = motion_of(file.header(), {});
        const AtlasMethod& m = case_.method;
        CauseRequest request;
        request.view.focus = {
            .lens = view_.lens, .focus_distance_m = view_.focus_m, .depth_model = m.depth_model};
        request.view.motion = &motion;
        request.view.shutter = view_.shutter;
        request.view.scene = &scene_;
        request.depths = m.depths;
        if (m.name == "scatter") request.method = FocusMethod::scatter;
        if (m.name == "lightfield") request.method = FocusMethod::lightfield;
        if (m.name == "hybrid") request.method = FocusMethod::hybrid;
        FocusFrame frame(file);
        const CauseMap map = find_error_causes(frame, image, reference, request);
        double most = -1;
        for (std::size_t k = 1; k < error_causes; ++k) {
            const auto name = cause_name(static_cast<ErrorCause>(k));
            if (name == case_.cause) out.named_share = map.error_share[k];
            if (map.error_share[k] > most) {
                most = map.error_share[k];
                out.named_most = name;
            }
        }
    }

    [[nodiscard]] Image beside_each_other(const std::vector<const Image*>& cells) const {
        const int w = view_.width, h = view_.height, n = static_cast<int>(cells.size());
        Image out(n * w + (n - 1) * gap_px, h);
        std::fill(out.rgb.begin(), out.rgb.end(), 1.0F);
        for (int k = 0; k < n; ++k) {
            for (int y = 0; y < h; ++y)
                std::copy_n(cells[static_cast<std::size_t>(k)]->pixel(0, y), 3 * w,
                            out.pixel(k * (w + gap_px), y));
        }
        return out;
    }

    const AtlasCase& case_;
    fs::path folder_;
    Scene scene_;
    ChartView view_;
    std::array<Image, 2> halves_;
    Image pinhole_;
    fs::path trace_path_;
    AtlasTrace trace_;
};

Json to_json(const AtlasFigures& f) {
    return {{"error", to_json(f.error)},         {"affected", to_json(f.affected)},
            {"energy", exact_number(f.energy)},  {"least_value", exact_number(f.least_value)},
            {"nonfinite", f.nonfinite},          {"warnings", f.warnings},
            {"retraced_share", f.retraced_share}};
}

AtlasFigures atlas_figures_from(const Json& j) {
    return {.error = error_from(j.at("error")),
            .affected = error_from(j.at("affected")),
            .energy = number_from(j.at("energy")),
            .least_value = number_from(j.at("least_value")),
            .nonfinite = j.at("nonfinite").get<std::size_t>(),
            .warnings = j.at("warnings").get<std::vector<std::string>>(),
            .retraced_share = j.at("retraced_share").get<double>()};
}

template <typename T>
std::string text_of(const std::optional<T>& value) {
    return value ? fmt::format("{}", *value) : "-";
}

std::string settings_text(const ChartRequest& v) {
    std::string out = fmt::format("'{}' {}x{} F {} n {} s {} {} spp", v.camera_name, text_of(v.camera.width),
                                  text_of(v.camera.height), text_of(v.focal_length_mm), text_of(v.f_number),
                                  text_of(v.focus_m), v.reference_spp);
    if (v.shutter) out += fmt::format(" shutter {}:{}", v.shutter->open_s, v.shutter->close_s);
    return out;
}

std::string settings_text(const AtlasMethod& m) {
    const AtlasTrace& t = m.trace;
    return fmt::format(
        "; {} views {} depths {} spp {} depth model {} spacing {} trace {} n {} s {} levels {} "
        "hidden {} "
        "overscan {} keys {} trees {}",
        m.name, text_of(m.views), text_of(m.depths), m.spp, static_cast<int>(m.depth_model),
        static_cast<int>(m.spacing), t.for_view, text_of(t.for_f_number), text_of(t.for_focus_m),
        text_of(t.levels), text_of(t.hidden_layers), text_of(t.overscan_px), text_of(t.keys),
        text_of(t.max_depth));
}

std::string codes(const std::vector<std::string>& warnings) {
    return warnings.empty() ? "none" : fmt::format("{}", fmt::join(warnings, ", "));
}

void check(const AtlasMethod& m, const AtlasFigures& f, std::vector<std::string>& out) {
    // Negated, so that a NaN fails too.
    if (!(f.error.psnr_db >= m.at_least_db))
        out.push_back(fmt::format("{}: PSNR (got {:.2f} dB; expected {} or more)", m.name, f.error.psnr_db,
                                  m.at_least_db));
    if (m.at_most_db && !(f.error.psnr_db <= *m.at_most_db))
        out.push_back(fmt::format("{}: PSNR (got {:.2f} dB; expected {} or less: it no longer fails)", m.name,
                                  f.error.psnr_db, *m.at_most_db));
    if (!(std::abs(f.energy - 1) <= m.energy_within))
        out.push_back(fmt::format("{}: energy (got {:.4f} of the reference's; expected 1 within {})", m.name,
                                  f.energy, m.energy_within));
    if (!(f.least_value >= least_allowed))
        out.push_back(fmt::format("{}: negative (got {}; expected 0 or more)", m.name, f.least_value));
    if (f.nonfinite != 0)
        out.push_back(fmt::format("{}: NaN or infinity (got {} pixels; expected none)", m.name, f.nonfinite));
    if (f.warnings != m.warnings)
        out.push_back(
            fmt::format("{}: warnings (got {}; expected {})", m.name, codes(f.warnings), codes(m.warnings)));
}

}  // namespace

std::string atlas_key(const AtlasCase& c) {
    Sha256 digest;
    digest.add(POSTLENS_VERSION);
    digest.add(settings_text(c.view));
    digest.add(settings_text(c.method));
    if (c.remedy) digest.add(settings_text(*c.remedy));
    digest.add(sha256_of_file(c.view.scene));
    return digest.hex().substr(0, 16);
}

AtlasResult run_atlas_case(const AtlasCase& c, const fs::path& folder, const fs::path& strip) {
    return CaseRun(c, folder).run(strip);
}

std::vector<std::string> broken_expectations(const AtlasCase& c, const AtlasResult& r) {
    std::vector<std::string> out;
    check(c.method, r.method, out);
    if (c.remedy && r.remedy) check(*c.remedy, *r.remedy, out);
    if (c.named_at_least > 0 && !(r.named_share.value_or(0) >= c.named_at_least)) {
        out.push_back(fmt::format(
            "{}: share of the error with the right cause (got {:.3f}, most is {}; expected {} or more)",
            c.method.name, r.named_share.value_or(0), r.named_most, c.named_at_least));
    }
    return out;
}

Json to_json(const AtlasResult& r) {
    return {{"key", r.key},
            {"named_share", r.named_share ? Json(*r.named_share) : Json(nullptr)},
            {"named_most", r.named_most},
            {"pinhole_db", exact_number(r.pinhole_db)},
            {"noise_db", exact_number(r.noise_db)},
            {"affected_share", r.affected_share},
            {"method", to_json(r.method)},
            {"remedy", r.remedy ? to_json(*r.remedy) : Json(nullptr)}};
}

AtlasResult atlas_from_json(const std::string& text, const fs::path& path) {
    try {
        const Json j = Json::parse(text);
        AtlasResult out{.key = j.at("key").get<std::string>(),
                        .pinhole_db = number_from(j.at("pinhole_db")),
                        .noise_db = number_from(j.at("noise_db")),
                        .affected_share = j.at("affected_share").get<double>(),
                        .method = atlas_figures_from(j.at("method")),
                        .remedy = std::nullopt};
        if (!j.at("remedy").is_null()) out.remedy = atlas_figures_from(j.at("remedy"));
        if (!j.at("named_share").is_null()) out.named_share = j.at("named_share").get<double>();
        out.named_most = j.at("named_most").get<std::string>();
        return out;
    } catch (const Json::exception& e) {
        fail(ExitCode::invalid_input, "{}: not a result of the atlas (got '{}'; expected JSON of chart)",
             path.string(), e.what());
    }
}

}  // namespace postlens
