// How many views a tile is drawn from, and which of its pixels are traced again: what costs least.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "planner/tile_grid.h"

namespace postlens {

/// What a pixel k of the picture, row by row, is expected to be off by, squared.
using PixelMse = std::function<double(std::uint32_t k)>;

/// What a tile is off by beside the noise of its views, when the worst n of its pixels are traced again: a
/// mean over its pixels.
struct TileRest {
    std::vector<std::uint32_t> pixels;  ///< the worst first
    std::vector<double> mean;           ///< by n
    std::vector<double> at_worst;       ///< by n: should its edges be worse than the mean

    /// Sorted by `at_worst`.
    TileRest(const TileGrid& grid, std::size_t tile, const PixelMse& mean, const PixelMse& at_worst);
    /// How many have to be traced again, so that no more than that is left of either; none: that cannot be.
    [[nodiscard]] std::optional<std::size_t> needed(double most_mean, double most_at_worst) const;
    /// How many have nearly all of it.
    [[nodiscard]] std::size_t nearly_all() const;
};

/// So many views of a tile, and so many of its pixels traced again.
struct TileChoice {
    int views = 0;
    double noise_mse = 0;
    std::size_t retraced = 0;
};

/// Of each tile's choices the cheapest. `ray_price`: what a pixel traced again costs, in pixels of views.
/// Where that would trace more than `most_retraced` pixels again, views become cheaper against them, twice as
/// cheap at a time, until it does not, or there is nothing more to be saved.
[[nodiscard]] std::vector<TileChoice> cheapest_choices(std::span<const std::vector<TileChoice>> choices,
                                                       const TileGrid& grid, double ray_price,
                                                       std::size_t most_retraced);

}  // namespace postlens
