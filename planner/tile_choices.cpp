#include "planner/tile_choices.h"

#include <algorithm>

namespace postlens {

TileRest::TileRest(const TileGrid& grid, std::size_t tile, const PixelMse& mean_of,
                   const PixelMse& at_worst_of) {
    const int edge = TileGrid::edge, x0 = static_cast<int>(tile) % grid.columns() * edge,
              y0 = static_cast<int>(tile) / grid.columns() * edge;
    struct Pixel {
        std::uint32_t k;
        double mean, at_worst;
    };
    std::vector<Pixel> all;
    double mean_sum = 0, worst_sum = 0;
    for (int y = y0; y < std::min(y0 + edge, grid.height); ++y) {
        for (int x = x0; x < std::min(x0 + edge, grid.width); ++x) {
            const auto k = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(grid.width) +
                           static_cast<std::uint32_t>(x);
            all.push_back({k, mean_of(k), at_worst_of(k)});
            mean_sum += all.back().mean;
            worst_sum += all.back().at_worst;
        }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Pixel& a, const Pixel& b) { return a.at_worst > b.at_worst; });
    const double share = 1.0 / static_cast<double>(all.size());
    mean.push_back(share * mean_sum);
    at_worst.push_back(share * worst_sum);
    for (const Pixel& p : all) {
        pixels.push_back(p.k);
        mean.push_back(mean.back() - share * p.mean);
        at_worst.push_back(at_worst.back() - share * p.at_worst);
    }
}

std::optional<std::size_t> TileRest::needed(double most_mean, double most_at_worst) const {
    for (std::size_t n = 0; n < mean.size(); ++n) {
        if (mean[n] <= most_mean && at_worst[n] <= most_at_worst) return n;
    }
    return std::nullopt;
}

std::size_t TileRest::nearly_all() const {
    std::size_t n = 0;
    while (n < pixels.size() && at_worst[n] > 0.01 * at_worst[0]) ++n;
    return n;
}

std::vector<TileChoice> cheapest_choices(std::span<const std::vector<TileChoice>> choices,
                                         const TileGrid& grid, double ray_price, std::size_t most_retraced) {
    const double highest = 1024 * ray_price;
    std::vector<TileChoice> out(choices.size());
    for (double price = ray_price; price <= highest; price *= 2) {
        std::size_t retraced = 0;
        for (std::size_t t = 0; t < choices.size(); ++t) {
            const auto cost = [&](const TileChoice& c) {
                return static_cast<double>(c.views) * grid.pixels(t) +
                       price * static_cast<double>(c.retraced);
            };
            out[t] = *std::min_element(choices[t].begin(), choices[t].end(),
                                       [&](const auto& a, const auto& b) { return cost(a) < cost(b); });
            retraced += out[t].retraced;
        }
        if (retraced <= most_retraced) break;
    }
    return out;
}

}  // namespace postlens
