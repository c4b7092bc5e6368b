#include "planner/tile_choices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace postlens {
namespace {

/// Of measured squared errors over expected ones, tile by tile.
constexpr double measured_median = 0.8, measured_deviation = 0.5;
/// What an expected error of as much as is allowed counts, against the chance of a tile to be at its target:
/// the whole picture has a target too, and a tile that misses its own should not miss it by much.
constexpr double mse_counts = 0.1;
/// Where the aims cannot be met, the part of what the best choices come to.
constexpr double nearly_best = 0.97, nearly_least = 1.1;
/// What a tile at its target may cost, in pixels of views: from next to nothing to more than any choice
/// costs.
constexpr double least_value = 1e3, most_value = 1e11, value_step = 1.3;
constexpr double dearest_rays = 1024;

struct Chosen {
    std::vector<TileChoice> tiles;
    std::size_t retraced = 0;
    double chance = 0, mse = 0, worth = 0;  ///< means of the tiles, of mse by pixels
};

/// Lagrange's way: what is cheapest for a given value of what is wanted is cheapest of all that come to as
/// much.
class Chooser {
  public:
    Chooser(std::span<const std::vector<TileChoice>> choices, const TileGrid& grid, const ChoiceAims& aims)
        : choices_(choices), grid_(grid), aims_(aims) {
        double best = 0, least = 0;
        for (std::size_t t = 0; t < choices.size(); ++t) {
            double chance = 0, mse = std::numeric_limits<double>::infinity();
            for (const TileChoice& c : choices[t]) {
                chance = std::max(chance, c.chance);
                mse = std::min(mse, c.mse);
            }
            best += chance / static_cast<double>(choices.size());
            least += mse * share(t);
        }
        enough_chance_ = std::min(aims.met_share, nearly_best * best);
        enough_mse_ = std::max(aims.most_mse, nearly_least * least);
    }

    [[nodiscard]] Chosen at(double price, double value) const {
        Chosen out;
        out.tiles.resize(choices_.size());
        for (std::size_t t = 0; t < choices_.size(); ++t) {
            double least = std::numeric_limits<double>::infinity();
            out.tiles[t] = choices_[t].front();
            for (const TileChoice& c : choices_[t]) {
                const double cost = static_cast<double>(c.views) * grid_.pixels(t) +
                                    price * static_cast<double>(c.retraced) - value * worth(c);
                if (cost >= least) continue;
                least = cost;
                out.tiles[t] = c;
            }
            const TileChoice& c = out.tiles[t];
            out.retraced += c.retraced;
            out.chance += c.chance / static_cast<double>(choices_.size());
            out.mse += c.mse * share(t);
            out.worth += worth(c) / static_cast<double>(choices_.size());
        }
        return out;
    }

    [[nodiscard]] bool enough(const Chosen& c) const {
        return c.chance >= enough_chance_ && c.mse <= enough_mse_;
    }

    /// Between two choices that are both best for some value others are not: what may be traced again beside
    /// goes to them.
    void spend_rest(ChosenTiles& chosen) const {
        if (chosen.retraced >= aims_.most_retraced) return;
        for (std::size_t t = 0; t < choices_.size(); ++t) {
            TileChoice& mine = chosen.tiles[t];
            const std::size_t most = mine.retraced + (aims_.most_retraced - chosen.retraced);
            for (const TileChoice& c : choices_[t]) {
                if (c.views != mine.views || c.retraced > most || worth(c) <= worth(mine)) continue;
                chosen.retraced += c.retraced - mine.retraced;
                mine = c;
            }
        }
    }

  private:
    [[nodiscard]] double share(std::size_t t) const {
        return static_cast<double>(grid_.pixels(t)) /
               (static_cast<double>(grid_.width) * static_cast<double>(grid_.height));
    }
    [[nodiscard]] double worth(const TileChoice& c) const {
        return c.chance - mse_counts * c.mse / aims_.most_mse;
    }

    std::span<const std::vector<TileChoice>> choices_;
    const TileGrid& grid_;
    const ChoiceAims& aims_;
    double enough_chance_ = 0, enough_mse_ = 0;
};

}  // namespace

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

std::size_t TileRest::nearly_all() const {
    std::size_t n = 0;
    while (n < pixels.size() && at_worst[n] > 0.01 * at_worst[0]) ++n;
    return n;
}

double chance_of(double mse, double at_worst_mse, double most_mse) {
    if (!(mse > 0)) return 1;
    // One in ten of a normal distribution lies above 1.2816 deviations.
    const double of_edges = std::log(std::max(1.0, at_worst_mse / mse)) / 1.2816,
                 deviation = std::hypot(measured_deviation, of_edges);
    const double x = std::log(most_mse / (measured_median * mse)) / deviation;
    return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

ChosenTiles cheapest_choices(std::span<const std::vector<TileChoice>> choices, const TileGrid& grid,
                             const ChoiceAims& aims) {
    const Chooser chooser(choices, grid, aims);
    // At first what costs nothing: of pictures without finite errors nothing is better.
    Chosen first = chooser.at(aims.ray_price, least_value);
    ChosenTiles out{std::move(first.tiles), first.retraced, 0};
    double best = -std::numeric_limits<double>::infinity();
    for (double price = aims.ray_price; price <= dearest_rays * aims.ray_price; price *= 2) {
        for (double value = least_value; value <= most_value; value *= value_step) {
            Chosen chosen = chooser.at(price, value);
            const bool enough = chooser.enough(chosen);
            if (price == aims.ray_price) out.wanted = chosen.retraced;
            if (chosen.retraced <= aims.most_retraced && (enough || chosen.worth > best)) {
                best = chosen.worth;
                out.retraced = chosen.retraced;
                out.tiles = std::move(chosen.tiles);
                if (enough) return out;
            }
            if (enough) break;
        }
    }
    chooser.spend_rest(out);
    return out;
}

}  // namespace postlens
