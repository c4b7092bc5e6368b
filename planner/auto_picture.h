// Makes an image as the mean of views (images from different lens points). Each tile gets as many views as a
// target error needs.
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
    /// Wanted PSNR of the image's sRGB values, 10 to 80 dB. If empty, default_target_db.
    std::optional<double> target_db;
};

struct AutoTile {
    int views = 0;
    bool left_to_rays = false;  ///< rays replace all view samples of the tile
    /// Squared error of the tile's sRGB values that is due to noise, as a mean over pixels and channels. It
    /// is measured relative to infinitely many views of the same sample file, so errors of this file do not
    /// count.
    double noise_mse = 0;
};

struct AutoResult {
    HybridResult hybrid;  ///< `focus.views` is the largest number of views of any tile
    TileGrid grid;
    std::vector<AutoTile> tiles;
    double mean_views = 0;
    /// Fraction of the view samples whose colour the sample file does not determine, because an edge is near
    /// or the surface there is not recorded. It is set only if the image was made without a scene.
    double unsure_share = 0;
    /// Squared errors of an image that was made without a scene, so that no rays could measure its whole
    /// error. `noise_mse` is the measured part that is due to noise. `bound_mse` is an upper bound of the
    /// whole error.
    double noise_mse = 0, bound_mse = 0;
    bool met = false;  ///< whether the stated error (without a scene, the noise) reaches the target
    [[nodiscard]] double noise_db() const;
    [[nodiscard]] double bound_db() const;
    std::string plan;  ///< views, error and rays in one sentence, for the log
};

/// Makes a light field image with as many views in each tile as the target error needs. It starts with a few
/// views per tile. Then it doubles the views where this reduces the error most for its cost.
///
/// Views are added until the upper end of the 95 % interval of the error is below the target. If the interval
/// is then wider than wanted_interval_db, up to eight times as many views are drawn (without a scene, twice
/// as many).
///
/// With a scene, rays replace view samples that the records do not determine, and measure the error of the
/// others.
///
/// A crop does not change the number of views of a tile. The result is bit-identical for any number of
/// threads. Throws the errors of hybrid_picture.
[[nodiscard]] AutoResult auto_picture(FocusFrame& frame, const AutoSettings& settings);

}  // namespace postlens
