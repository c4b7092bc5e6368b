#include "planner/weighed_rays.h"

#include <algorithm>
#include <map>
#include <vector>

#include "planner/retrace.h"
#include "records/srgb.h"

namespace postlens {
namespace {

constexpr int set_rays = first_rays / 2, most_rays = 1024;
/// Of what a tile may be off by, what its rays may add.
constexpr double left_by_rays = 0.1;

/// Of the mean of two independent ones, each for what it is worth.
double both_mse(double a, double b) {
    return a + b > 0 ? a * b / (a + b) : 0;
}

class Tracing {
  public:
    Tracing(const Scene& scene, RenderSettings rays, const PixelsAgain& again, HybridResult& out)
        : scene_(scene), rays_(std::move(rays)), again_(again), out_(out), views_(out.focus.image) {}

    void run() {
        first_sets();
        more();
        weigh();
        out_.retraced_share =
            static_cast<double>(again_.pixels.size()) / static_cast<double>(out_.what.size());
    }

  private:
    void trace(int spp, std::uint64_t seed, std::vector<std::uint32_t> pixels) {
        rays_.spp = spp;
        rays_.seed = seed;
        retrace(scene_, rays_, std::move(pixels), out_);
    }

    void first_sets() {
        const std::vector<std::uint32_t> pixels(again_.pixels.begin(), again_.pixels.end());
        Image& picture = out_.focus.image;
        trace(set_rays, 1, pixels);
        traced_ = picture;
        trace(set_rays, 2, pixels);
        noise_.assign(again_.grid.count(), 0);
        std::vector<int> count(noise_.size());
        for (const std::uint32_t k : pixels) {
            ++count[tile_of(k)];
            for (std::size_t c = 3 * std::size_t{k}; c < 3 * std::size_t{k} + 3; ++c) {
                const double d = static_cast<double>(srgb_from_linear(traced_.rgb[c])) -
                                 static_cast<double>(srgb_from_linear(picture.rgb[c]));
                noise_[tile_of(k)] += d * d / 12;
                traced_.rgb[c] = (traced_.rgb[c] + picture.rgb[c]) / 2;
            }
        }
        for (std::size_t t = 0; t < noise_.size(); ++t) noise_[t] /= std::max(1, count[t]);
    }

    void more() {
        std::vector<double> left(noise_.size());
        for (const std::uint32_t k : again_.pixels) {
            left[tile_of(k)] +=
                both_mse(again_.of_views(k), noise_[tile_of(k)]) / again_.grid.pixels(tile_of(k));
        }
        std::map<int, std::vector<std::uint32_t>> by_rays;
        for (const std::uint32_t k : again_.pixels) {
            const double factor = left[tile_of(k)] / (left_by_rays * again_.tile_mse);
            int spp = set_rays;
            while (spp < most_rays && spp < first_rays * (factor - 1)) spp *= 2;
            if (factor > 1) by_rays[spp].push_back(k);
        }
        rays_of_.assign(noise_.size(), first_rays);
        const Image& picture = out_.focus.image;
        for (const auto& [spp, some] : by_rays) {
            trace(spp, 3, some);
            const float share = static_cast<float>(spp) / static_cast<float>(spp + first_rays);
            for (const std::uint32_t k : some) {
                rays_of_[tile_of(k)] = spp + first_rays;
                for (std::size_t c = 3 * std::size_t{k}; c < 3 * std::size_t{k} + 3; ++c)
                    traced_.rgb[c] += share * (picture.rgb[c] - traced_.rgb[c]);
            }
        }
    }

    void weigh() {
        Image& picture = out_.focus.image;
        for (const std::uint32_t k : again_.pixels) {
            const double spp = rays_of_[tile_of(k)], of_views = again_.of_views(k),
                         of_rays = (noise_[tile_of(k)] * first_rays + again_.unseen_by_rays(k)) / spp;
            const auto share = static_cast<float>(of_views > 0 ? of_views / (of_views + of_rays) : 1);
            for (std::size_t c = 3 * std::size_t{k}; c < 3 * std::size_t{k} + 3; ++c)
                picture.rgb[c] = views_.rgb[c] + share * (traced_.rgb[c] - views_.rgb[c]);
        }
    }

    [[nodiscard]] std::size_t tile_of(std::uint32_t pixel) const {
        const auto width = static_cast<std::uint32_t>(again_.grid.width);
        return again_.grid.at(static_cast<int>(pixel % width), static_cast<int>(pixel / width));
    }

    const Scene& scene_;
    RenderSettings rays_;
    const PixelsAgain& again_;
    HybridResult& out_;
    Image views_, traced_;
    std::vector<double> noise_;  ///< by tile: of first_rays, of one of its pixels
    std::vector<int> rays_of_;   ///< by tile
};

}  // namespace

void trace_weighed(const Scene& scene, RenderSettings rays, const PixelsAgain& again, HybridResult& out) {
    if (!again.pixels.empty()) Tracing(scene, std::move(rays), again, out).run();
}

}  // namespace postlens
