// The picture with as many views as its stated error asks for, tile by tile.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/hybrid.h"
#include "planner/tile_grid.h"

namespace postlens {

inline constexpr double default_target_db = 40;

struct AutoSettings {
    HybridSettings hybrid;  ///< `focus.views` and `checked` do not count
    /// PSNR wanted of the picture, encoded values; 10 to 80. None: default_target_db, of which nobody is
    /// warned where, without a scene, the bound misses it.
    std::optional<double> target_db;
};

struct AutoTile {
    int views = 0;              ///< points of the lens
    bool left_to_rays = false;  ///< altogether
    double noise_mse = 0;       ///< measured, encoded values, mean of pixels and channels
};

struct AutoResult {
    HybridResult hybrid;  ///< `focus.views`: the most of any tile
    TileGrid grid;
    std::vector<AutoTile> tiles;
    double mean_views = 0;
    /// Without a scene, of all view samples: those that the records are not sure of.
    double unsure_share = 0;
    /// Without a scene, in place of `hybrid.stated`: the noise of the views, measured; and at most, with
    /// all of these as wrong as they can be (records_bound.h).
    double noise_mse = 0, bound_mse = 0;
    bool met = false;  ///< what is stated, or without a scene the noise, is no worse than the target
    [[nodiscard]] double noise_db() const;
    [[nodiscard]] double bound_db() const;
    std::string plan;  ///< a sentence
};

/// Draws few views of every tile and doubles them where that takes away most of the stated error for its
/// cost, until that is at the target with a certainty of 97.5 %. With a scene, view samples that the records
/// are unsure of are rays, and so is all of a tile whose other samples are found to be wrong by more than the
/// noise, or by what keeps the picture from its target. Without a scene what the records do not show stays
/// so, and is not in what is measured. Tiles have the same views with a crop as without. Same bits for any
/// number of threads. Throws what hybrid_picture throws.
[[nodiscard]] AutoResult auto_picture(FocusFrame& frame, const AutoSettings& settings);

}  // namespace postlens
