// Makes an image with as many views in each tile as a target error needs.
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
    /// Wanted PSNR of the whole image, of sRGB values, 10 to 80 dB. If absent, the target is
    /// default_target_db, and there is no warning if the error bound misses it.
    std::optional<double> target_db;
};

struct AutoTile {
    int views = 0;
    bool left_to_rays = false;  ///< rays replace all view samples of the tile
    double layers_weight = 0;   ///< weight of the image made by `layers`, 0 to 1
    /// Measured error of the views and of `layers`; sRGB values, mean over pixels and channels.
    double noise_mse = 0;
};

struct AutoResult {
    HybridResult hybrid;  ///< `focus.views` is the largest number of views of any tile
    TileGrid grid;
    std::vector<AutoTile> tiles;
    double mean_views = 0;
    double layers_share = 0;  ///< mean of `layers_weight` over the pixels of the image or crop
    /// Share of the view samples (what one view sees in one pixel) that the records do not determine. Set
    /// only if no scene is given.
    double unsure_share = 0;
    /// noise_mse: measured noise of the views. bound_mse: upper bound of the error from this noise and from
    /// view samples that the records do not determine (planner/errors/records_bound.h). Both are set only if
    /// no scene is given; `hybrid.stated` is then empty.
    double noise_mse = 0, bound_mse = 0;
    bool met = false;  ///< whether the stated error (without a scene, the noise) reaches the target
    [[nodiscard]] double noise_db() const;
    [[nodiscard]] double bound_db() const;
    std::string plan;  ///< views, error and rays in one sentence, for the log
};

/// Makes a light field image with as many views in each tile as the target error needs. Starts with a few
/// views per tile. Then repeatedly doubles the number of views in those tiles where this reduces the error
/// most in relation to its cost. The target is met when the upper end of the 95 % interval of the image's
/// error is below it. If the interval is then wider than wanted_interval_db, up to four times as many views
/// narrow it. In tiles where the check rays measure the error least accurately, rays also replace all view
/// samples. Views are also added if `layers` alone may have less than half the error.
///
/// Unsure view samples are those that the records do not determine. If a scene is given, rays replace them,
/// and check rays measure the error of all other view samples. Where this error exceeds a tile's noise, or
/// prevents the image from reaching its target, rays replace all view samples of the tile. If no scene is
/// given, unsure samples keep their recorded colours, and their error is not measured.
///
/// With a scene and without a shutter, `layers` also makes the image, unless the file has so many records
/// that this takes longer than the first views. The two halves of the views measure the error of this image.
/// The image by `layers` is mixed with the views, in each tile with the weight that gives the least error.
///
/// A crop does not change the number of views of a tile. The result is bit-identical for any number of
/// threads. Throws the errors of hybrid_picture.
[[nodiscard]] AutoResult auto_picture(FocusFrame& frame, const AutoSettings& settings);

}  // namespace postlens
