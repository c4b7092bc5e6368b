#include "planner/stated_error.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

/// 95 % of a normal distribution lie within this number of standard deviations.
constexpr double deviations = 1.96;

/// Smallest squared error that is stated.
constexpr double smallest_mse = 1e-12;

}  // namespace

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

StatedError stated_error(const MeasuredError& measured) {
    StatedError out{.bias_mse = std::max(measured.bias_mse, std::sqrt(measured.bias_variance)),
                    .highlights_mse = std::max(0.0, measured.highlights_mse),
                    .check_rays = measured.check_rays};
    double pixels = 0;
    for (const TileError& tile : measured.tiles) pixels += tile.pixels;
    pixels = std::max(pixels, 1.0);
    for (const TileError& tile : measured.tiles) {
        const double share = tile.pixels / pixels;
        out.views_mse += share * tile.noise_mse;
        out.variance += share * share * tile.noise_variance;
    }
    // Raises `views_mse`, the estimated squared noise of the image, to at least its own standard deviation.
    // The estimate is random, with the variance `variance`. So it may by chance be close to 0, although the
    // noise is not.
    out.views_mse = std::max(out.views_mse, std::sqrt(out.variance));
    out.variance += measured.bias_variance;
    const double mse = out.mse();
    if (!(mse > 0)) return out;
    const double factor = std::exp(deviations * std::sqrt(out.variance) / mse);
    out.low_mse = mse / factor;
    out.high_mse = mse * factor;
    return out;
}

}  // namespace postlens
