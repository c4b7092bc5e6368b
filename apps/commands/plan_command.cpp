#include "apps/commands/plan_command.h"

#include <cmath>
#include <utility>

#include "apps/scene_input.h"
#include "pictures/srgb.h"
#include "scene/scene.h"

namespace postlens {
namespace {

// Writes an image in which colours show how each pixel was computed. Blue: from the records, by blurring
// them. Grey: by averaging views (images from single lens points); brighter means more views. Red: mostly
// from rays.
void write_explanation(const std::string& path, const HybridResult& r, const AutoResult* plan,
                       const std::optional<Crop>& crop) {
    Image out(r.focus.image.width, r.focus.image.height);
    constexpr float tint[3][3] = {{1, 1, 1}, {0.35F, 0.6F, 1.6F}, {2, 0.3F, 0.2F}};
    for (std::size_t k = 0; k < r.what.size(); ++k) {
        const float* rgb = r.focus.image.rgb.data() + 3 * k;
        float grey = 0.1F + 0.6F * std::min(1.0F, luminance(rgb));
        if (plan != nullptr && r.what[k] == 0) {
            const auto x = static_cast<int>(k % static_cast<std::size_t>(out.width)),
                       y = static_cast<int>(k / static_cast<std::size_t>(out.width));
            // The brightness grows with the logarithm of the number of views.
            const auto views = static_cast<float>(plan->tiles[plan->grid.at(x, y)].views);
            grey *= 0.25F * std::max(0.25F, std::log2(views) - 3);
        }
        for (std::size_t c = 0; c < 3; ++c) out.rgb[3 * k + c] = grey * tint[r.what[k]][c];
    }
    write_image(path, out, crop);
}

// Reads the scene into which rays are traced. Returns nothing if the user names no scene. Throws if the scene
// refers to one of the output files, because it would be overwritten.
std::optional<Scene> scene_of(const RetraceOptions& retrace, const SampleFileReader& file,
                              const std::string& picture, CommandResult& out) {
    // The name of the output image `explain` is checked first, so that an invalid name is reported before the
    // long work.
    if (retrace.explain) check_image_path(*retrace.explain);
    if (!retrace.scene) return std::nullopt;
    std::vector<std::filesystem::path> written{picture};
    if (retrace.explain) written.emplace_back(*retrace.explain);
    return read_scene_of_file(*retrace.scene, retrace.metres_per_unit, retrace.lumens_per_watt, file, written,
                              out);
}

}  // namespace

void check_units(const RetraceOptions& options) {
    if (options.scene) return;
    for (const auto& [name, value] : {std::pair{"--metres-per-unit", options.metres_per_unit},
                                      std::pair{"--lumens-per-watt", options.lumens_per_watt}}) {
        if (!value) continue;
        fail(ExitCode::wrong_arguments, "{}: of which scene? (got {}; expected --scene with it)", name,
             *value);
    }
}

HybridResult run_hybrid(FocusFrame& frame, HybridSettings settings, const RetraceOptions& retrace,
                        const std::string& picture, CommandResult& out) {
    const std::optional<Scene> scene = scene_of(retrace, frame.file(), picture, out);
    settings.scene = scene ? &*scene : nullptr;
    HybridResult result = hybrid_picture(frame, settings);
    if (retrace.explain) write_explanation(*retrace.explain, result, nullptr, settings.focus.crop);
    return result;
}

nlohmann::ordered_json shares_json(const HybridResult& r) {
    nlohmann::ordered_json out{{"scattered_share", r.scattered_share},
                               {"insufficient_share", r.wanted_share},
                               {"ray_share", r.retraced_share},
                               {"rays", rays_json(r.rays)}};
    if (!r.stated) return out;
    out["stated_db"] = out["predicted_db"] = json_number(r.stated->db());
    out["stated_low_db"] = json_number(r.stated->low_db());
    out["stated_high_db"] = json_number(r.stated->high_db());
    out["stated"] = {{"noise_mse", r.stated->views_mse}, {"bias_mse", r.stated->bias_mse}};
    out["check_rays"] = r.stated->check_rays;
    return out;
}

AutoResult run_auto(FocusFrame& frame, AutoSettings settings, const RetraceOptions& retrace,
                    const std::string& picture, CommandResult& out) {
    const std::optional<Scene> scene = scene_of(retrace, frame.file(), picture, out);
    settings.hybrid.scene = scene ? &*scene : nullptr;
    AutoResult result = auto_picture(frame, settings);
    if (!result.met) out.exit_code = ExitCode::shortfall;
    if (retrace.explain)
        write_explanation(*retrace.explain, result.hybrid, &result, settings.hybrid.focus.crop);
    return result;
}

void report_prediction(const PredictedError& predicted, CommandResult& out) {
    out.json["predicted_db"] = json_number(predicted.predicted_db);
    out.json["bound_db"] = json_number(predicted.bound_db);
    out.json["unsure_share"] = predicted.unsure_share;
    nlohmann::ordered_json tiles = nlohmann::ordered_json::array();
    for (const PredictedTile& t : predicted.tiles) {
        tiles.push_back({{"method_mse", t.method_mse}, {"bound_mse", t.bound_mse}});
    }
    out.json["prediction"] = {{"views", predicted.views},
                              {"tile_px", TileGrid::edge},
                              {"columns", predicted.grid.columns()},
                              {"tiles", std::move(tiles)}};
    out.text +=
        fmt::format(", predicted {:.1f} dB without the error of the records, at least {:.1f} dB with it",
                    predicted.predicted_db, predicted.bound_db);
}

nlohmann::ordered_json auto_json(const AutoResult& r) {
    nlohmann::ordered_json out = shares_json(r.hybrid);
    if (!r.hybrid.stated) {
        out["predicted_db"] = json_number(r.noise_db());
        out["bound_db"] = json_number(r.bound_db());
        out["unsure_share"] = r.unsure_share;
    }
    nlohmann::ordered_json tiles = nlohmann::ordered_json::array();
    for (const AutoTile& t : r.tiles) {
        tiles.push_back({{"views", t.views}, {"left_to_rays", t.left_to_rays}, {"noise_mse", t.noise_mse}});
    }
    out["plan"] = {{"mean_views", r.mean_views},
                   {"tile_px", TileGrid::edge},
                   {"columns", r.grid.columns()},
                   {"tiles", std::move(tiles)}};
    return out;
}

}  // namespace postlens
