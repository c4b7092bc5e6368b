// Measures the noise of two independent references, and estimates the error that an image would have against
// a reference without noise.
#pragma once

#include <cstddef>

#include "compare/metrics/pixel_errors.h"
#include "compare/metrics/pixel_mask.h"

namespace postlens {

/// Estimate of an image's mean squared error against the truth T, from two noisy references R1 and R2. If
/// their errors are independent with mean zero, (I - R1)(I - R2) has the same mean as (I - T)^2.
struct NoisyError {
    double mse = 0;             ///< the estimate; may be negative; NaN if no pixel counts
    double standard_error = 0;  ///< standard error of mse
    /// Upper bound of the bias of `mse`, as an RMS error. sRGB encoding is nonlinear, so it shifts the mean
    /// of noisy values, which causes this bias.
    double bias_rms = 0;
    /// Ends of the confidence interval of the image's RMS error. They are two standard errors below and above
    /// the estimate, and further apart by the estimate's possible bias.
    [[nodiscard]] double least_rms() const;
    [[nodiscard]] double greatest_rms() const;
    /// Returns true if the confidence interval of the image's RMS error includes zero. Its upper end,
    /// `greatest_rms`, is then only an upper bound of the error.
    [[nodiscard]] bool is_bound() const { return !(least_rms() > 0); }
};

struct NoiseFloor {
    double reference_mse = 0;  ///< error of one reference in sRGB values: mean (R1 - R2)^2 / 2
    /// Noise of a single reference in scene-linear values: RMSE and relMSE that it would have against an
    /// ideal reference without noise. relMSE divides each squared error by M^2 + 0.01, where M is the mean of
    /// the two noisy references.
    double reference_rmse = 0, reference_relmse = 0;
    NoisyError encoded;   ///< error of the image apart from the noise, in sRGB values
    NoisyError linear;    ///< the same in scene-linear values
    NoisyError relative;  ///< the same in scene-linear values, divided by M^2 + 0.01
    /// Mean squared error against the first reference minus that against the second, divided by this
    /// difference's standard error. If the image is equally close to both except for chance, it is standard
    /// normal.
    double preference = 0;
};

/// Estimates the image's errors over the pixels that `mask` counts, by comparing it with two noisy references
/// (docs/compare.md). All images must have the same size.
///
/// Standard errors come from sums over blocks of 16 x 16 px or less. They assume Gaussian errors that are
/// independent between blocks.
[[nodiscard]] NoiseFloor noise_floor(const Picture& image, const Picture& reference,
                                     const Picture& second_reference, const PixelMask& mask);

}  // namespace postlens
