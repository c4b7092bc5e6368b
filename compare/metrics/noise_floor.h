// Noise of a reference, from two independent references, and the error of an image without that noise.
#pragma once

#include <cstddef>

#include "compare/metrics/pixel_errors.h"
#include "compare/metrics/pixel_mask.h"

namespace postlens {

/// Estimate of the mean squared error of an image I against the truth T, from two noisy references R1 = T +
/// e1 and R2 = T + e2. If e1 and e2 are independent and of mean 0, mean (I - R1)(I - R2) has the expectation
/// mean (I - T)^2.
struct NoisyError {
    double mse = 0;             ///< the estimate; may be below 0. NaN where no pixel counts
    double standard_error = 0;  ///< standard error of mse
    /// Bound on a bias of the estimate: the sRGB encoding of noisy values shifts the mean of a reference. The
    /// bound is a root mean square.
    double bias_rms = 0;
    /// Ends of the interval of the root mean square error, at two standard errors.
    [[nodiscard]] double least_rms() const;
    [[nodiscard]] double greatest_rms() const;
    /// True if the interval contains an error of zero. Only `greatest_rms` may be stated then.
    [[nodiscard]] bool is_bound() const { return !(least_rms() > 0); }
};

struct NoiseFloor {
    double reference_mse = 0;  ///< error of one reference, of sRGB values: mean (R1 - R2)^2 / 2
    /// Error of one reference in scene-linear values: as a root mean square, and relative to M^2 + 0.01,
    /// where M is the mean of both references.
    double reference_rmse = 0, reference_relmse = 0;
    NoisyError encoded;   ///< error of the image above the noise, of sRGB values
    NoisyError linear;    ///< the same of scene-linear values
    NoisyError relative;  ///< the same of scene-linear values, relative to M^2 + 0.01
    /// Difference of the image's errors against the two references, in its standard errors: (mean (I - R1)^2
    /// - mean (I - R2)^2) / standard error, of scene-linear values. It is standard normal if the references
    /// are equally accurate and the image is independent of both.
    double preference = 0;
};

/// Estimates the errors over the pixels that `mask` counts, for images of one size. Standard errors come from
/// blocks of 16 x 16 pixels, or smaller ones if fewer than 64 such blocks would count. With A = I - R1 and B
/// = I - R2, for the image I and the references R1 and R2, the variance of a block's sum of AB is the
/// expectation of (sum of A^2 - B^2)^2 / 4. This holds for Gaussian errors that are independent between
/// blocks, with any covariance within a block. Errors with longer tails make the standard errors too large.
/// Details: docs/compare.md.
[[nodiscard]] NoiseFloor noise_floor(const Picture& image, const Picture& reference,
                                     const Picture& second_reference, const PixelMask& mask);

}  // namespace postlens
