// A sample file in the viewer.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>

#include "apps/open_frame.h"
#include "apps/view/viewed_frame.h"
#include "core/files/scratch_file.h"
#include "pictures/srgb.h"
#include "records/coarser_file.h"

namespace postlens {
namespace {

using Json = nlohmann::ordered_json;

/// Those samples of a pixel that show the same object along the same light path, for example by one
/// reflection. They are listed as one entry. Their weights are proportional to their luminance.
struct MergedNodes {
    /// `light` is the sum of the weights, and `inverse_depth` is the sum of weight / depth. The quotient is
    /// the mean inverse depth.
    double light = 0, inverse_depth = 0;
    const Json* first = nullptr;
};

class ViewedRecords : public ViewedFrame {
  public:
    ViewedRecords(const std::string& input, Json info)
        : input_(input), facts_(std::move(info)), kept_(std::make_shared<KeptFrame>(input, Damage::refuse)) {
        facts_.erase("ids");
        const SampleHeader header = SampleFileReader(input, Damage::refuse, 0.0).header();
        if (header.projection == Projection::orthographic) {
            fail(
                ExitCode::invalid_input,
                "{}: no lens can have taken it (got an orthographic sample file; expected a perspective one)",
                input);
        }
        facts_["focus_m"] = focus_fact(header.focus_m);
    }

    [[nodiscard]] Json facts() const override { return facts_; }
    [[nodiscard]] std::shared_ptr<KeptFrame> kept() const override { return kept_; }

    [[nodiscard]] Records coarse() const override {
        const std::lock_guard lock(coarse_mutex_);
        if (!coarse_) coarse_ = made_coarse();
        return *coarse_;
    }

    [[nodiscard]] ImageDepths depths() const override {
        return image_depths(SampleFileReader(input_, Damage::refuse, 0.0));
    }

    [[nodiscard]] Json pixel(double x, double y, const LensOptions& lens) const override {
        RecordsOptions options{.input = input_, .at = {x, y}};
        options.lens = lens;
        const Json json = run_records(options).json;
        std::map<std::pair<std::string, std::uint32_t>, MergedNodes> seen;
        for (const Json& sample : json["samples"]) {
            for (const Json& node : sample["nodes"]) {
                if (node["layer"] != 0) continue;
                const auto rgb = node["rgb"].get<std::array<double, 3>>();
                const double weight =
                    sample["weight"].get<double>() * std::max(1e-12, luminance(rgb[0], rgb[1], rgb[2]));
                MergedNodes& s = seen[{node["path"].get<std::string>(), node["id"].get<std::uint32_t>()}];
                const auto& w = node["w_per_m"];
                const double inverse = w.is_null() ? 0 : (w[0][0].get<double>() + w[1][1].get<double>()) / 2;
                s.light += weight;
                s.inverse_depth += weight * inverse;
                if (s.first == nullptr) s.first = &node;
            }
        }
        Json out{{"x", json["x"]}, {"y", json["y"]}, {"nodes", Json::array()}};
        std::vector<const MergedNodes*> by_light;
        double all = 0;
        for (const auto& [key, s] : seen) {
            by_light.push_back(&s);
            all += s.light;
        }
        std::stable_sort(by_light.begin(), by_light.end(),
                         [](const MergedNodes* a, const MergedNodes* b) { return a->light > b->light; });
        for (const MergedNodes* s : by_light) {
            const double inverse = s->inverse_depth / s->light;
            Json node = *s->first;
            node.erase("rgb");
            node["share"] = s->light / all;
            // Stores the focus distance of the surface, 1 / `inverse`. It is null if the distance is
            // infinite. It is also null if `inverse` is negative: then no lens can focus on the surface,
            // because a mirror or glass makes its light converge.
            node["focus_m"] = inverse > 0 ? Json(1 / inverse) : Json(nullptr);
            node["behind_infinity"] = inverse < 0;
            out["nodes"].push_back(std::move(node));
        }
        // `clicked` is the surface on which the web page focuses the lens if the user clicks on the pixel. It
        // is the brightest surface that the pixel shows, i.e. the first in the list `nodes`, which is sorted
        // by brightness.
        out["clicked"] = out["nodes"].empty() ? Json(nullptr) : out["nodes"][0];
        return out;
    }

  private:
    [[nodiscard]] Records made_coarse() const {
        // Files with at most this many pixels and records are not made coarser for the preview. Two cores
        // then make an image in about 50 ms.
        constexpr double most_pixels = 150000, most_records = 250000;
        const SampleFileReader file(input_, Damage::refuse, 0.0);
        const int width = file.header().width, height = file.header().height;
        double records = 0;
        for (const ScanlineFacts& row : file.scanlines()) records += row.records;
        const double pixels = static_cast<double>(width) * height,
                     less = std::max(pixels / most_pixels, corner_records(file) / most_records);
        if (less <= 1 && records <= most_records) return {input_, kept_, 1};
        const int by = std::clamp(static_cast<int>(std::ceil(std::sqrt(less))), 1, std::min(width, height));
        coarse_file_.emplace("coarse.exr");
        const std::string path = coarse_file_->path().string();
        write_coarser_file(file, by, path);
        return {path, std::make_shared<KeptFrame>(path, Damage::refuse), by};
    }

    std::string input_;
    Json facts_;
    std::shared_ptr<KeptFrame> kept_;
    mutable std::mutex coarse_mutex_;
    mutable std::optional<ScratchFile> coarse_file_;
    mutable std::optional<Records> coarse_;
};

}  // namespace

std::unique_ptr<ViewedFrame> view_records(const std::string& input, Json info) {
    return std::make_unique<ViewedRecords>(input, std::move(info));
}

Json focus_fact(const std::optional<double>& focus_m) {
    if (!focus_m) return nullptr;
    return std::isinf(*focus_m) ? Json("inf") : Json(*focus_m);
}

std::unique_ptr<ViewedFrame> open_viewed_frame(const std::string& input) {
    Json info = run_info({.input = input}).json;
    if (info["kind"] == "samples") return view_records(input, std::move(info));
    if (is_foreign(input)) return view_foreign_picture(input, std::move(info));
    fail(ExitCode::invalid_input,
         "{}: nothing to view (got the kind \"{}\"; expected a sample file or an OpenEXR picture)", input,
         info["kind"].get<std::string>());
}

}  // namespace postlens
