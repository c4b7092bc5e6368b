// Compares an image with two independent, noisy references. Measures the noise of the references, and the
// error that the image has apart from this noise.
#pragma once

#include <cstddef>

#include "compare/metrics/pixel_errors.h"
#include "compare/metrics/pixel_mask.h"

namespace postlens {

/// An estimate of the mean squared error of an image I against the truth T. It is computed from two noisy
/// references R1 = T + e1 and R2 = T + e2. If the errors e1 and e2 are independent and have zero mean, the
/// expectation of mean (I - R1)(I - R2) is mean (I - T)^2.
struct NoisyError {
    double mse = 0;             ///< the estimate; may be negative; NaN if no pixel counts
    double standard_error = 0;  ///< standard error of mse
    /// Upper bound of the bias of the estimate, as a root mean square. There is a bias because the sRGB
    /// encoding shifts the mean of noisy values.
    double bias_rms = 0;
    /// Ends of the interval that contains the root mean square error. They are two standard errors below and
    /// above the estimate.
    [[nodiscard]] double least_rms() const;
    [[nodiscard]] double greatest_rms() const;
    /// Returns true if the interval includes zero. In this case only `greatest_rms` is meaningful, as a
    /// bound.
    [[nodiscard]] bool is_bound() const { return !(least_rms() > 0); }
};

struct NoiseFloor {
    double reference_mse = 0;  ///< error of one reference in sRGB values: mean (R1 - R2)^2 / 2
    /// Error of one reference in scene-linear values, as a root mean square and relative to M^2 + 0.01. M is
    /// the mean of both references.
    double reference_rmse = 0, reference_relmse = 0;
    NoisyError encoded;   ///< error of the image without the noise, in sRGB values
    NoisyError linear;    ///< the same in scene-linear values
    NoisyError relative;  ///< the same in scene-linear values, relative to M^2 + 0.01
    /// Tells which reference the image is closer to. Positive values mean the second one. For the image I and
    /// the references R1 and R2, the value is (mean (I - R1)^2 - mean (I - R2)^2) / standard error, in
    /// scene-linear values. It has a standard normal distribution if both references are equally accurate and
    /// the image is independent of them.
    double preference = 0;
};

/// Estimates the errors over the pixels that `mask` counts. All images must have the same size. Standard
/// errors are computed from sums over blocks of 16 x 16 pixels, or over smaller blocks if there would be
/// fewer than 64 blocks. They are correct if the errors are Gaussian and independent between blocks. They are
/// too large if the distribution of errors has longer tails. docs/compare.md gives the derivation.
[[nodiscard]] NoiseFloor noise_floor(const Picture& image, const Picture& reference,
                                     const Picture& second_reference, const PixelMask& mask);

}  // namespace postlens
