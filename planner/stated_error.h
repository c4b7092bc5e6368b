// Computes the measured error of an image that is made from a sample file and traced rays. It consists of the
// noise and of the error of the colours in the file.
#pragma once

#include <cstdint>
#include <vector>

#include "planner/errors/measured_error.h"

namespace postlens {

/// Wanted accuracy of an image's measured error: the width, in dB, of its 95 % confidence interval. If the
/// interval is wider, more views (images from different lens points) are averaged.
inline constexpr double wanted_interval_db = 2;

/// Converts a squared error to PSNR, at most 120 dB.
[[nodiscard]] double stated_db(double mse);

/// The measured squared error of an image that is the mean of views (images from different lens points). It
/// consists of the noise of the views and the error of the records in the sample file. Squared errors are
/// means over pixels and channels, of sRGB values clamped to [0, 1].
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

/// Returns the error of an image and its 95 % interval. `measured` contains the two parts of the error: the
/// noise, and the error of the colours in the sample file. The logarithm of the error is assumed to be
/// normally distributed.
[[nodiscard]] StatedError stated_error(const MeasuredError& measured);

}  // namespace postlens
