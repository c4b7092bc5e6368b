// Measures the noise of two independent references, and estimates the error that an image would have against
// a reference without noise.
#pragma once

#include <cstddef>

#include "compare/metrics/pixel_errors.h"
#include "compare/metrics/pixel_mask.h"

namespace postlens {

/// Estimate of the mean squared error of an image I against the true image T, which is unknown. It uses two
/// references, R1 and R2, with independent noise of mean zero. Therefore, the product (I - R1)(I - R2) has
/// the same mean as (I - T)^2.
struct NoisyError {
    double mse = 0;             ///< the estimate; may be negative; NaN if no pixel counts
    double standard_error = 0;  ///< standard error of mse
    /// Upper bound of the bias of the estimated error `mse`, as an RMS error. The bias arises because sRGB
    /// encoding is nonlinear: the mean of encoded noisy values differs from the encoded value without noise.
    double bias_rms = 0;
    /// Lower and upper end of the confidence interval of the image's RMS error. They are two standard errors
    /// below and above the estimate. Because the estimate may be biased (`bias_rms`), the interval is
    /// extended at both ends by the possible bias.
    [[nodiscard]] double least_rms() const;
    [[nodiscard]] double greatest_rms() const;
    /// Returns true if the confidence interval of the image's RMS error begins at zero, so that the image may
    /// have no error at all. The upper end of the interval, `greatest_rms`, is then only an upper bound of
    /// the error.
    [[nodiscard]] bool is_bound() const { return !(least_rms() > 0); }
};

struct NoiseFloor {
    double reference_mse = 0;  ///< error of one reference in sRGB values: mean (R1 - R2)^2 / 2
    /// Noise of one reference image in scene-linear values. It is estimated from two references with
    /// independent noise, whose mean is M. `reference_rmse` is the root mean square (RMS) of the noise.
    /// `reference_relmse` is the mean of its square divided by M^2 + 0.01.
    double reference_rmse = 0, reference_relmse = 0;
    NoisyError encoded;   ///< error of the image apart from the noise, in sRGB values
    NoisyError linear;    ///< the same in scene-linear values
    NoisyError relative;  ///< the same in scene-linear values, divided by M^2 + 0.01
    /// Tells which of the two references the image is nearer to: negative for the first, positive for the
    /// second. It is the difference between the image's mean squared errors against the two references,
    /// divided by the standard error of this difference. If the image is equally close to both except for
    /// chance, the result has a standard normal distribution.
    double preference = 0;
};

/// Estimates the errors of `image` apart from noise, by comparing it with two noisy references
/// (docs/compare.md). Only pixels that `mask` counts are used. All images must have the same size. The
/// standard errors are computed from sums over blocks of at most 16 x 16 px, whose errors are assumed to be
/// Gaussian and independent of each other.
[[nodiscard]] NoiseFloor noise_floor(const Picture& image, const Picture& reference,
                                     const Picture& second_reference, const PixelMask& mask);

}  // namespace postlens
