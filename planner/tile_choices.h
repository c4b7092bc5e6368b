// How many views a tile is drawn from, and which of its pixels are traced again: what costs least.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
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
    /// How many have nearly all of it.
    [[nodiscard]] std::size_t nearly_all() const;
};

/// So many views of a tile, and so many of its pixels traced again.
struct TileChoice {
    int views = 0;
    double noise_mse = 0;  ///< of the views
    std::size_t retraced = 0;
    double mse = 0;     ///< expected, all in all
    double chance = 0;  ///< that the tile is at its target
};

/// How probable it is that a tile that is expected to be off by `mse`, and by `at_worst_mse` should its edges
/// be as bad as one in ten is, is off by `most_mse` at most: what is measured strays from what is expected as
/// a log-normal does, of which docs/planner.md has the fit.
[[nodiscard]] double chance_of(double mse, double at_worst_mse, double most_mse);

/// What the choices of all tiles together are to come to.
struct ChoiceAims {
    double most_mse = 0;     ///< of the whole picture on the mean, and of a tile at its target
    double met_share = 0.9;  ///< of the tiles, expected
    double ray_price = 0;    ///< what a pixel traced again costs, in pixels of views
    std::size_t most_retraced = 0;
};

struct ChosenTiles {
    std::vector<TileChoice> tiles;
    std::size_t retraced = 0;
    /// How many would be, if there were no limit.
    std::size_t wanted = 0;
};

/// Of each tile one choice, so that all together cost least and come to `aims`; where that cannot be, to as
/// much of it as can be had: nearly the best that the choices allow. A tile where little is gained at a high
/// price is left for the others. Where more than aims.most_retraced pixels would be traced again, views
/// become cheaper against them, twice as cheap at a time; if that does not help, the tiles where tracing
/// again gains least go without.
[[nodiscard]] ChosenTiles cheapest_choices(std::span<const std::vector<TileChoice>> choices,
                                           const TileGrid& grid, const ChoiceAims& aims);

}  // namespace postlens
