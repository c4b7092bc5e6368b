// Compares an image with two independent, noisy references. Measures the noise of the references, and the
// error of the image without this noise.
#pragma once

#include <cstddef>

#include "compare/metrics/pixel_errors.h"
#include "compare/metrics/pixel_mask.h"

namespace postlens {

/// Estimates the mean squared error of an image I against the truth T, from two noisy references R1 = T + e1
/// and R2 = T + e2. If e1 and e2 are independent and have the mean 0, then mean (I - R1)(I - R2) has the
/// expectation mean (I - T)^2.
struct NoisyError {
    double mse = 0;             ///< the estimate; may be below 0. NaN where no pixel counts
    double standard_error = 0;  ///< standard error of mse
    /// Bound of the bias of the estimate, as a root mean square. The bias arises because the sRGB encoding
    /// shifts the mean of noisy values.
    double bias_rms = 0;
    /// Ends of the interval of the root mean square error. The interval extends two standard errors to either
    /// side of the estimate.
    [[nodiscard]] double least_rms() const;
    [[nodiscard]] double greatest_rms() const;
    /// True if the interval contains an error of zero. Then only `greatest_rms` may be stated.
    [[nodiscard]] bool is_bound() const { return !(least_rms() > 0); }
};

struct NoiseFloor {
    double reference_mse = 0;  ///< error of one reference, of sRGB values: mean (R1 - R2)^2 / 2
    /// Error of one reference in scene-linear values: as a root mean square, and relative to M^2 + 0.01. M is
    /// the mean of both references.
    double reference_rmse = 0, reference_relmse = 0;
    NoisyError encoded;   ///< error of the image above the noise, of sRGB values
    NoisyError linear;    ///< the same of scene-linear values
    NoisyError relative;  ///< the same, of scene-linear values relative to M^2 + 0.01
    /// Tests which reference the image agrees with: (mean (I - R1)^2 - mean (I - R2)^2) / standard error, of
    /// scene-linear values, for the image I and the references R1 and R2. The result is standard normal if
    /// the references are equally accurate and the image is independent of both.
    double preference = 0;
};

/// Estimates the errors over the pixels that `mask` counts. All images have the same size. Standard errors
/// are computed from blocks of 16 x 16 pixels, or smaller ones if there would be fewer than 64 such blocks.
/// Let A = I - R1 and B = I - R2, for the image I and the references R1 and R2. The variance of a block's sum
/// of AB is then the expectation of (sum of A^2 - B^2)^2 / 4. This holds for Gaussian errors that are
/// independent between blocks, with any covariance within a block. For errors with longer tails, the standard
/// errors are too large. Details: docs/compare.md.
[[nodiscard]] NoiseFloor noise_floor(const Picture& image, const Picture& reference,
                                     const Picture& second_reference, const PixelMask& mask);

}  // namespace postlens
