// An image with as many views per tile as a target error needs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/hybrid.h"
#include "planner/views/tile_grid.h"

namespace postlens {

inline constexpr double default_target_db = 40;

struct AutoSettings {
    HybridSettings hybrid;  ///< `focus.views` and `checked` are ignored
    /// Wanted PSNR of the whole image, of sRGB values, 10 to 80 dB. Absent: default_target_db, and no warning
    /// if the error bound misses this target.
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
    /// Share of the view samples that the records do not determine. Only set without a scene.
    double unsure_share = 0;
    /// noise_mse: measured noise of the views. bound_mse: upper bound of the error that noise and unsure view
    /// samples cause together (planner/errors/records_bound.h). Only set without a scene, where
    /// `hybrid.stated` is empty.
    double noise_mse = 0, bound_mse = 0;
    bool met = false;  ///< whether the stated error (without a scene, the noise) reaches the target
    [[nodiscard]] double noise_db() const;
    [[nodiscard]] double bound_db() const;
    std::string plan;  ///< views, error and rays in one sentence, for the log
};

/// Makes a light field image with as many views per tile as the target error needs. Starts with a few views
/// per tile. Then repeatedly doubles the number of views of those tiles where this reduces the error most for
/// its cost, until the upper end of the 95 % interval of the image's error is below the target.
///
/// Unsure view samples are those that the records do not determine. With a scene, they are replaced by rays.
/// Check rays also measure the error of the other samples: if it exceeds a tile's noise or keeps the image
/// from its target, rays replace all view samples of the tile. Without a scene, unsure samples stay as
/// recorded, and their error is not measured.
///
/// A crop does not change the views of a tile. The result is bit-identical for any number of threads. Throws
/// what hybrid_picture throws.
[[nodiscard]] AutoResult auto_picture(FocusFrame& frame, const AutoSettings& settings);

}  // namespace postlens
