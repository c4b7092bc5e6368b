// The cheapest picture that is as good as asked for, planned tile by tile from the records.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "planner/hybrid.h"
#include "planner/tile_grid.h"

namespace postlens {

inline constexpr double default_target_db = 40;
/// Of the tiles, so many are promised to be at the target.
inline constexpr double promised_share = 0.9;

struct AutoSettings {
    HybridSettings hybrid;  ///< `focus.views` and `tolerated` do not count
    /// PSNR wanted of every tile, encoded values; 10 to 80.
    double target_db = default_target_db;
};

/// Expected squared errors of a tile, encoded values, mean of pixels and channels.
struct TilePlan {
    int views = 0;          ///< points of the lens
    double noise_mse = 0;   ///< of so many views
    double floor_mse = 0;   ///< of the records' density
    double hidden_mse = 0;  ///< of what no record shows, and of what W misplaces
    double retraced = 0;    ///< share of the pixels
    double chance = 0;      ///< to be at the target
    [[nodiscard]] double mse() const { return noise_mse + floor_mse + hidden_mse; }
};

struct AutoResult {
    HybridResult hybrid;
    TileGrid grid;
    std::vector<TilePlan> tiles;
    double predicted_db = 0;  ///< of the whole picture
    double met_share = 0;     ///< of the tiles, as predicted: the mean of their chances
    double mean_views = 0;
    std::string plan;  ///< a sentence
    [[nodiscard]] bool met(double target_db) const {
        return predicted_db >= target_db && met_share >= promised_share;
    }
};

/// Draws two small sets of views, whose difference tells the noise of any number of views tile by tile; adds
/// what the records' density, holes and curved W must cost; gives every tile the views that it needs
/// and, with a scene, traces again the pixels that keep a tile from its
/// target. What no record tells, such as shading that changes over the lens, is not in the prediction. Same
/// bits for any number of threads. Throws what hybrid_picture throws.
[[nodiscard]] AutoResult auto_picture(FocusFrame& frame, const AutoSettings& settings);

}  // namespace postlens
