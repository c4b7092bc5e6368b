#include "chart/atlas/atlas_case.h"

#include <algorithm>
#include <array>
#include <fmt/ranges.h>

#include "core/files/text_file.h"
#include "core/toml_reader.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;
using Name = std::string_view;

constexpr std::uintmax_t largest_case_bytes = 1U << 20U;
constexpr double inf = std::numeric_limits<double>::infinity();

AtlasTrace read_trace(const TomlTable& t) {
    static constexpr std::array<Name, 8> known{"for_view",      "for_f_number", "for_focus_m", "levels",
                                               "hidden_layers", "overscan_px",  "keys",        "max_depth"};
    t.allow_only({known});
    AtlasTrace out;
    out.for_view = t.flag("for_view").value_or(true);
    out.for_f_number = t.number("for_f_number", {.min = 0, .excludes_min = true});
    out.for_focus_m = t.number("for_focus_m", {.min = 0, .may_be_infinite = true, .excludes_min = true});
    out.levels = t.integer("levels", 0, 8);
    out.hidden_layers = t.integer("hidden_layers", 0, 16);
    out.overscan_px = t.integer("overscan_px", 0, 4096);
    out.keys = t.integer("keys", 1, 64);
    out.max_depth = t.integer("max_depth", 1, 16);
    return out;
}

std::string one_of(const TomlTable& t, Name key, std::span<const Name> choices) {
    return std::string(choices[t.required(t.choice(key, choices), key)]);
}

AtlasMethod read_method(const TomlTable& t, const ChartRequest& view) {
    static constexpr std::array<Name, 11> known{"name",          "views",   "depths",      "spp",
                                                "depth_model",   "trace",   "at_least_db", "at_most_db",
                                                "energy_within", "spacing", "warnings"};
    static constexpr std::array<Name, 6> of_lens{"pinhole",    "scatter", "layers",
                                                 "lightfield", "hybrid",  "rays"};
    static constexpr std::array<Name, 4> of_shutter{"convolve", "lightfield", "auto", "rays"};
    static constexpr std::array<Name, 4> of_both{"lightfield", "hybrid", "focus-after-shutter", "rays"};
    static constexpr std::array<Name, 3> models{"W", "path", "first-hit"};
    static constexpr std::array<Name, 2> spacings{"linear", "inverse"};
    t.allow_only({known});
    AtlasMethod out;
    const bool has_lens = !view.f_number || *view.f_number < inf;
    out.name = one_of(t, "name",
                      !view.shutter ? std::span<const Name>(of_lens)
                      : has_lens    ? std::span<const Name>(of_both)
                                    : std::span<const Name>(of_shutter));
    out.views = t.integer("views", 1, 4096);
    out.depths = t.integer("depths", 2, 4096);
    out.spp = t.integer("spp", 1, 1 << 20).value_or(out.spp);
    out.depth_model = static_cast<DepthModel>(t.choice("depth_model", models).value_or(0));
    out.spacing = static_cast<DepthSpacing>(
        t.choice("spacing", spacings).value_or(static_cast<std::size_t>(DepthSpacing::inverse)));
    if (const auto trace = t.table("trace")) out.trace = read_trace(*trace);
    out.at_least_db = t.required(t.number("at_least_db"), "at_least_db");
    out.at_most_db = t.number("at_most_db", {.min = out.at_least_db});
    out.energy_within = t.required(t.number("energy_within", {.min = 0}), "energy_within");
    out.warnings = t.texts("warnings").value_or(std::vector<std::string>());
    std::sort(out.warnings.begin(), out.warnings.end());
    return out;
}

ChartRequest read_view(const TomlTable& t, const fs::path& folder) {
    static constexpr std::array<Name, 8> known{"scene",    "camera",  "size_px",   "focal_length_mm",
                                               "f_number", "focus_m", "shutter_s", "reference_spp"};
    t.allow_only({known});
    ChartRequest out;
    out.scene = folder / t.required(t.text("scene"), "scene");
    out.camera_name = t.text("camera").value_or("");
    const auto size = t.required(t.numbers("size_px", 2, {.min = 1, .max = 4096}), "size_px");
    out.camera.width = static_cast<int>(size[0]);
    out.camera.height = static_cast<int>(size[1]);
    out.focal_length_mm = t.number("focal_length_mm", {.min = 0, .excludes_min = true});
    out.f_number = t.number("f_number", {.min = 0, .may_be_infinite = true, .excludes_min = true});
    out.focus_m = t.number("focus_m", {.min = 0, .may_be_infinite = true, .excludes_min = true});
    if (const auto shutter = t.numbers("shutter_s", 2)) out.shutter = TimeSpan{(*shutter)[0], (*shutter)[1]};
    out.reference_spp = t.required(t.integer("reference_spp", 1, 1 << 16), "reference_spp");
    if (!out.f_number && !out.shutter) t.fail_here("has neither 'f_number' nor 'shutter_s' (expected one)");
    if (!out.f_number) out.f_number = inf;
    return out;
}

std::string sentences(const TomlTable& t, Name key) {
    return fmt::format("{}", fmt::join(t.required(t.texts(key), key), " "));
}

}  // namespace

const std::vector<AtlasCause>& atlas_causes() {
    static const std::vector<AtlasCause> causes{
        {"hidden-surface",
         "The lens or the shutter sees a surface that the pinhole does not see, and that is not recorded.",
         "surfaces that the sample file lacks"},
        {"visibility",
         "The method blends surfaces without testing, at each lens point, which of them is nearer.",
         "wrong occlusion"},
        {"curvature-of-W",
         "W is the linear approximation of how images in mirrors and glass move with the lens point. "
         "It is wrong far from the centre of the lens.",
         "wrong positions of images in mirrors and glass"},
        {"view-dependent-shading",
         "The colour of a point depends on the lens point and the instant from which it is seen. The records "
         "have the colour for the pinhole and the frame's instant.",
         "light that changes with the lens point or the instant"},
        {"path-and-depth-correlated",
         "While an object moves, its depth, its outline or its occluder changes, so one path is not "
         "enough to blur it.",
         "motion that differs between points of one object"},
        {"frame-edge", "Light comes into the picture from beyond the border of the records.",
         "light from beyond the frame's border"},
        {"kernel-truncation", "An impulse response is too coarse, too small or too large for its raster.",
         "inaccurate blur kernels"},
        {"record-density", "There are too few point samples, views or instants to represent the scene.",
         "too few samples, views or instants"},
        {"none", "Extreme settings and depths, for which the results must still be right.",
         "extreme settings"}};
    return causes;
}

AtlasCase read_atlas_case(const fs::path& path) {
    const std::string file = path.string();
    AtlasCase out;
    out.name = path.stem().string();
    const toml::table document = parse_toml(read_text_file(path, largest_case_bytes), file);
    const TomlTable t(file, document, "case");
    static constexpr std::array<Name, 10> known{"title",     "set",     "cause", "named_at_least", "why",
                                                "detection", "outcome", "view",  "method",         "remedy"};
    t.allow_only({known});
    static constexpr std::array<Name, 2> sets{"calibrate", "check"};
    std::vector<Name> causes;
    for (const AtlasCause& c : atlas_causes()) causes.push_back(c.word);
    out.title = t.required(t.text("title"), "title");
    out.set = one_of(t, "set", sets);
    out.cause = one_of(t, "cause", causes);
    out.named_at_least = t.number("named_at_least", {.min = 0, .max = 1}).value_or(0);
    out.why = sentences(t, "why");
    out.detection = sentences(t, "detection");
    out.outcome = sentences(t, "outcome");
    out.view = read_view(t.required(t.table("view"), "view"), path.parent_path());
    out.method = read_method(t.required(t.table("method"), "method"), out.view);
    if (const auto remedy = t.table("remedy")) out.remedy = read_method(*remedy, out.view);
    if (out.cause != "none" && !out.method.at_most_db)
        t.fail_at("method", "has no 'at_most_db' (expected one, as the cause is '{}')", out.cause);
    return out;
}

std::vector<fs::path> atlas_case_files(const fs::path& folder) {
    std::vector<fs::path> out;
    std::error_code error;
    for (const fs::directory_entry& e : fs::directory_iterator(folder, error)) {
        if (e.path().extension() == ".toml") out.push_back(e.path());
    }
    if (out.empty()) {
        fail(ExitCode::invalid_input, "{}: holds no cases (got no .toml file; expected one or more)",
             folder.string());
    }
    std::sort(out.begin(), out.end());
    return out;
}

}  // namespace postlens
