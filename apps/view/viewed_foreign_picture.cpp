// An image of another program in the viewer.
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "apps/view/viewed_frame.h"
#include "pictures/srgb.h"
#include "pictures/stacks/unmix_edges.h"

namespace postlens {
namespace {

using Json = nlohmann::ordered_json;

/// Largest number of samples that are sent to the viewer's web page for one pixel of another program's image.
/// A limit is needed because a pixel that shows smoke may have thousands of samples at different depths.
constexpr std::size_t most_nodes = 64;

/// Returns a distance in metres for JSON. Null means infinity.
Json distance_json(double inverse_m) {
    return inverse_m > 0 ? Json(1 / inverse_m) : Json(nullptr);
}

class ViewedForeignPicture : public ViewedFrame {
  public:
    /// Reads an image of another program. The two arguments `{}` are default options, for the image's
    /// channels and its camera. The command `focus` uses the same defaults, so the web page shows the same
    /// depths as `focus` uses.
    ViewedForeignPicture(const std::string& input, Json info)
        : facts_(std::move(info)), picture_(read_foreign_picture(input, {}, {})) {
        unmix_edges(picture_);
        if (picture_.channels.matte) {
            const auto objects = manifest_objects(picture_.channels.matte->manifest);
            if (objects) {
                for (const ManifestObject& o : *objects) names_.try_emplace(o.id, o.name);
            }
        }
        const ForeignCamera& camera = picture_.camera;
        const std::vector<float> inverse = depths().inverse_per_m;
        const float nearest = *std::max_element(inverse.begin(), inverse.end());
        facts_.update({{"width", picture_.width},
                       {"height", picture_.height},
                       {"focal_length_mm", camera.focal_length_mm},
                       {"film_distance_mm", camera.film_distance_mm},
                       {"film_distance_from_focal_length", camera.film_distance_from_focal_length},
                       {"pixel_pitch_mm", picture_.pixel_pitch_mm()},
                       {"f_number", camera.f_number ? json_number(*camera.f_number) : nullptr},
                       {"focus_m", focus_fact(camera.focus_m)},
                       {"nearest_m", distance_json(static_cast<double>(nearest))}});
    }

    [[nodiscard]] Json facts() const override { return facts_; }
    [[nodiscard]] Records coarse() const override {
        fail(ExitCode::wrong_arguments, "coarse: another program's picture has no records");
    }

    [[nodiscard]] ImageDepths depths() const override { return image_depths(picture_); }

    [[nodiscard]] Json pixel(double at_x, double at_y, const LensOptions& lens) const override {
        const double column = std::floor(at_x), row = std::floor(at_y);
        if (!(column >= 0 && column < picture_.width && row >= 0 && row < picture_.height)) {
            fail(ExitCode::wrong_arguments,
                 "x, y: outside the picture (got {:g},{:g}; expected 0 to {}, 0 to {})", at_x, at_y,
                 picture_.width, picture_.height);
        }
        const int x = static_cast<int>(column), y = static_cast<int>(row);
        const std::optional<FocusGeometry> geometry = geometry_of(lens);
        Json out{{"x", x}, {"y", y}, {"nodes", Json::array()}, {"clicked", nullptr}};
        if (!picture_.stores(x, y)) return out;
        struct Seen {
            const StackSample* sample;
            double light;
        };
        std::vector<Seen> by_light;
        double left = 1, all = 0;
        for (const StackSample& s : picture_.stack(x, y)) {
            // Collects the samples of the pixel. For each, `light` is the light that it adds to the pixel.
            // Later, the samples are sorted by `light`, and only the brightest are listed.
            const auto alpha = static_cast<double>(s.alpha);
            const double luminance = exact_luminance(std::array<float, 3>{s.r, s.g, s.b}.data());
            // Black samples would all add the same light, none. To sort them by opacity, they get the tiny
            // luminance 1e-12 times alpha.
            by_light.push_back({&s, left * std::max(1e-12 * alpha, luminance)});
            all += by_light.back().light;
            left *= 1 - alpha;
        }
        std::stable_sort(by_light.begin(), by_light.end(),
                         [](const Seen& a, const Seen& b) { return a.light > b.light; });
        by_light.resize(std::min(by_light.size(), most_nodes));
        for (const Seen& s : by_light) {
            Json node = node_of(s.sample, geometry);
            node["share"] = all > 0 ? s.light / all : 0.0;
            out["nodes"].push_back(std::move(node));
        }
        out["clicked"] = node_of(picture_.seen_sample(x, y), geometry);
        return out;
    }

  private:
    [[nodiscard]] std::optional<FocusGeometry> geometry_of(const LensOptions& lens) const {
        const ForeignCamera& camera = picture_.camera;
        const auto f_number = lens.f_number ? lens.f_number : camera.f_number;
        const auto focus_m = lens.focus_m ? lens.focus_m : camera.focus_m;
        if (!f_number || !focus_m) return std::nullopt;
        const double focal_length_mm = lens.focal_length_mm.value_or(camera.focal_length_mm);
        const double film_distance_mm =
            camera.film_distance_from_focal_length ? focal_length_mm : camera.film_distance_mm;
        return focus_geometry({.focal_length_mm = focal_length_mm, .f_number = *f_number}, *focus_m,
                              Framing::keep, {film_distance_mm, picture_.pixel_pitch_mm()});
    }

    /// Describes a sample of a pixel as JSON. A null `sample` stands for the background, which is infinitely
    /// far.
    [[nodiscard]] Json node_of(const StackSample* sample,
                               const std::optional<FocusGeometry>& geometry) const {
        const double inverse_m = sample == nullptr ? 0 : static_cast<double>(sample->inverse_z);
        const std::uint32_t id = sample == nullptr ? 0 : sample->id;
        Json node{{"id", id},
                  {"name", name_of(id)},
                  {"z_m", distance_json(inverse_m)},
                  {"focus_m", distance_json(inverse_m)}};
        if (sample != nullptr) node["alpha"] = sample->alpha;
        if (geometry) {
            const double coc_px = std::abs(geometry->coc_diameter_px(inverse_m));
            node["coc_px"] = {coc_px, coc_px};
        }
        return node;
    }

    /// Returns the name of an object, or its id as text if the object has no name. Empty for the id 0, which
    /// means no object.
    [[nodiscard]] std::string name_of(std::uint32_t id) const {
        if (id == 0) return "";
        if (const auto found = names_.find(id); found != names_.end()) return found->second;
        if (picture_.channels.matte) return fmt::format("{:08x}", id);
        return picture_.whole_ids ? fmt::format("{}", id) : fmt::format("{:g}", std::bit_cast<float>(id));
    }

    Json facts_;
    ForeignPicture picture_;
    std::map<std::uint32_t, std::string> names_;
};

}  // namespace

std::unique_ptr<ViewedFrame> view_foreign_picture(const std::string& input, Json info) {
    return std::make_unique<ViewedForeignPicture>(input, std::move(info));
}

}  // namespace postlens
