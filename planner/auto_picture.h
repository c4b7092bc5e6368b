// An image with as many views per tile as a target error needs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/hybrid.h"
#include "planner/tile_grid.h"

namespace postlens {

inline constexpr double default_target_db = 40;

struct AutoSettings {
    HybridSettings hybrid;  ///< `focus.views` and `checked` are ignored
    /// Wanted PSNR of the whole image, of sRGB values, 10 to 80 dB. None: default_target_db; then a bound
    /// that misses the target causes no warning.
    std::optional<double> target_db;
};

struct AutoTile {
    int views = 0;
    bool left_to_rays = false;  ///< every view sample of the tile is a ray
    double noise_mse = 0;       ///< measured; sRGB values, mean over pixels and channels
};

struct AutoResult {
    HybridResult hybrid;  ///< `focus.views` is the largest number of views of any tile
    TileGrid grid;
    std::vector<AutoTile> tiles;
    double mean_views = 0;
    /// Share of the view samples that are unsure. Only without a scene.
    double unsure_share = 0;
    /// Measured noise of the views, and the bound of noise and unsure samples together (records_bound.h).
    /// Only without a scene, where `hybrid.stated` is empty.
    double noise_mse = 0, bound_mse = 0;
    bool met = false;  ///< whether the stated error (without a scene, the noise) reaches the target
    [[nodiscard]] double noise_db() const;
    [[nodiscard]] double bound_db() const;
    std::string plan;  ///< views, error and rays in one sentence, for the log
};

/// Starts with a few views per tile. Doubles the views of the tiles where this removes most error per cost,
/// until the upper end of the 95 % interval of the error is below the target. With a scene, unsure view
/// samples are rays; a tile becomes rays altogether where check rays find an error of its sure samples that
/// exceeds the noise or keeps the image from its target. Without a scene, unsure samples stay as recorded,
/// and their error is not measured. A crop does not change the views of a tile. Same bits for any number of
/// threads. Throws what hybrid_picture throws.
[[nodiscard]] AutoResult auto_picture(FocusFrame& frame, const AutoSettings& settings);

}  // namespace postlens
