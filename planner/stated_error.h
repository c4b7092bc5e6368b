// Computes the error of an image whose samples are partly reprojected from the sample file and partly traced.
#pragma once

#include <cstdint>
#include <vector>

#include "planner/errors/measured_error.h"

namespace postlens {

/// Wanted width of the 95 % interval of an image's measured error, in dB. More views narrow it.
inline constexpr double wanted_interval_db = 2;

/// Converts a squared error to PSNR, at most 120 dB.
[[nodiscard]] double stated_db(double mse);

/// The measured squared error of an image that is the mean of views (images from different lens points). It
/// has two parts. The noise arises because the number of views is limited. The error of the records arises
/// because colours in the sample file are inaccurate or missing. Squared errors are means over pixels and
/// channels, of sRGB values clamped to [0, 1].
struct StatedError {
    double views_mse = 0;              ///< noise of the views
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

/// Returns the error of an image and its 95 % interval. The image is the mean of views (images from different
/// lens points), which form two independent halves. `measured` contains the noise, found by comparing these
/// halves, and the error of the records, found by tracing rays. The interval assumes that the logarithm of
/// the error is normally distributed.
[[nodiscard]] StatedError stated_error(const MeasuredError& measured);

}  // namespace postlens
