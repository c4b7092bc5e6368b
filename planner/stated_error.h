// Computes the error of an image that is made from reprojected views and rays, and possibly blended with
// another image.
#pragma once

#include <cstdint>
#include <vector>

#include "planner/errors/measured_error.h"

namespace postlens {

/// Wanted width of the 95 % interval of an image's error, in dB.
inline constexpr double wanted_interval_db = 2;

/// How a tile blends the mean of its views with another image of the same scene. The other image has the
/// weight `weight`, the views 1 - `weight`.
struct TileMix {
    double weight = 0;    ///< 0 to 1
    double optimism = 0;  ///< amount by which the tile's measured error is expected to be too small
    /// Squared error of the tile, without errors of the sample file.
    [[nodiscard]] double mse(const TileError& measured) const;
};

/// Converts a squared error to PSNR, at most 120 dB.
[[nodiscard]] double stated_db(double mse);

/// The measured error of an image, by cause. Squared errors are means over pixels and channels, of sRGB
/// values clamped to [0, 1].
struct StatedError {
    double views_mse = 0;              ///< noise of the views, or error of their blend with another image
    double bias_mse = 0;               ///< error of the records
    double highlights_mse = 0;         ///< the part of `bias_mse` that highlights cause
    double variance = 0;               ///< variance of the estimate `mse()`
    double low_mse = 0, high_mse = 0;  ///< 95 % interval of the image's error
    std::uint64_t check_rays = 0;
    [[nodiscard]] double mse() const { return views_mse + bias_mse; }
    [[nodiscard]] double db() const;
    [[nodiscard]] double low_db() const;   ///< PSNR of high_mse
    [[nodiscard]] double high_db() const;  ///< PSNR of low_mse
    [[nodiscard]] double width_db() const { return width_db(mse(), variance); }
    [[nodiscard]] static double width_db(double mse, double variance);
};

/// Returns the error of an image, as measured from two halves of its views (`measured`). With `mix` (one
/// element per tile), the mean of the views is blended with another image. The 95 % interval assumes that the
/// logarithm of the error is normally distributed.
///
/// If the other image has the weight w, a tile has this squared error:
///
///     (1 - w)^2 noise + w^2 e^2 + bias
///
/// Here `noise` is the squared noise of the mean of the views. e is the difference between the other image
/// and the mean of infinitely many views. `bias` is the squared error of the recorded data.
[[nodiscard]] StatedError stated_error(const MeasuredError& measured, const std::vector<TileMix>& mix = {});

/// Chooses blend weights so that the error's 95 % confidence interval is, if possible, at most
/// wanted_interval_db wide.
[[nodiscard]] std::vector<TileMix> mixed_tiles(const MeasuredError& measured);

}  // namespace postlens
