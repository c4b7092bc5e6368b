#include "planner/stated_error.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

/// 95 % of a normal distribution lie within this number of standard deviations.
constexpr double deviations = 1.96;

/// Smallest squared error that is stated.
constexpr double smallest_mse = 1e-12;

/// Returns the blend weight that minimises squared error + `price` * variance of its estimate.
double weight_of(const TileError& tile, double price) {
    const double whole = tile.noise_mse + std::max(tile.other_mse, 0.0) +
                         4 * price * (tile.of_noise + std::max(tile.of_product, 0.0));
    return whole > 0 ? (tile.noise_mse + 2 * price * tile.of_noise) / whole : 0;
}

/// Chooses the blend weight. Cross-validation measures how much fitting this weight to noise lowers the
/// measured error.
TileMix mix_of(const TileError& tile, double price) {
    TileMix out{.weight = weight_of(tile, price)};
    if (!(out.weight > 0)) return out;
    out.optimism = -out.mse(tile);
    for (const TileError& piece : tile.pieces) {
        const TileError others{.noise_mse = tile.noise_mse - piece.noise_mse,
                               .other_mse = tile.other_mse - piece.other_mse,
                               .of_noise = tile.of_noise - piece.of_noise,
                               .of_product = tile.of_product - piece.of_product};
        out.optimism += TileMix{.weight = std::clamp(weight_of(others, price), 0.0, 1.0)}.mse(piece);
    }
    return out;
}

}  // namespace

double TileMix::mse(const TileError& measured) const {
    return (1 - weight) * (1 - weight) * measured.noise_mse + weight * weight * measured.other_mse + optimism;
}

double stated_db(double mse) {
    return -10 * std::log10(std::max(mse, smallest_mse));
}

double StatedError::db() const {
    return stated_db(mse());
}
double StatedError::low_db() const {
    return stated_db(high_mse);
}
double StatedError::high_db() const {
    return stated_db(low_mse);
}

double StatedError::width_db(double mse, double variance) {
    return mse > smallest_mse ? 2 * deviations * std::sqrt(variance) / mse * 10 / std::log(10.0) : 0;
}

StatedError stated_error(const MeasuredError& measured, const std::vector<TileMix>& mix) {
    StatedError out{.bias_mse = std::max(measured.bias_mse, std::sqrt(measured.bias_variance)),
                    .highlights_mse = std::max(0.0, measured.highlights_mse),
                    .check_rays = measured.check_rays};
    double pixels = 0;
    for (const TileError& tile : measured.tiles) pixels += tile.pixels;
    pixels = std::max(pixels, 1.0);
    for (std::size_t t = 0; t < measured.tiles.size(); ++t) {
        const TileError& tile = measured.tiles[t];
        const TileMix of_tile = mix.empty() ? TileMix{} : mix[t];
        const double share = tile.pixels / pixels;
        out.views_mse += share * of_tile.mse(tile);
        out.variance += share * share * tile.estimate_variance(of_tile.weight);
    }
    // By chance, the estimate may be too small or negative, so its standard deviation is a lower bound.
    out.views_mse = std::max(out.views_mse, std::sqrt(out.variance));
    out.variance += measured.bias_variance;
    const double mse = out.mse();
    if (!(mse > 0)) return out;
    const double factor = std::exp(deviations * std::sqrt(out.variance) / mse);
    out.low_mse = mse / factor;
    out.high_mse = mse * factor;
    return out;
}

std::vector<TileMix> mixed_tiles(const MeasuredError& measured) {
    // The error of the sample file is left out, because it does not depend on the blend weights.
    MeasuredError of_views = measured;
    of_views.bias_variance = 0;
    const StatedError views = stated_error(of_views);
    std::vector<TileMix> best(measured.tiles.size());
    if (!(views.variance > 0)) return best;
    double pixels = 0;
    for (const TileError& tile : measured.tiles) pixels += tile.pixels;
    constexpr int steps = 32;
    double least_mse = views.high_mse;
    for (int step = 0; step <= steps; ++step) {
        const double price = step == 0 ? 0 : std::ldexp(views.mse() / views.variance, step - steps / 2);
        std::vector<TileMix> mix;
        for (const TileError& tile : measured.tiles)
            mix.push_back(mix_of(tile, price * tile.pixels / pixels));
        const StatedError stated = stated_error(of_views, mix);
        const bool is_known = stated.width_db() <= wanted_interval_db;
        if (is_known || stated.high_mse < least_mse) {
            least_mse = stated.high_mse;
            best = std::move(mix);
        }
        if (is_known) break;
    }
    return best;
}

}  // namespace postlens
