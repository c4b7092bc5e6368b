// Error of the reference itself, from two independent references, and an image's error without it.
#pragma once

#include <cstddef>

#include "compare/pixel_errors.h"
#include "compare/pixel_mask.h"

namespace postlens {

/// Estimate of the mean squared error of an image I against the truth T, from two noisy references R1 = T +
/// e1 and R2 = T + e2. If e1 and e2 are independent and of mean 0, mean (I - R1)(I - R2) has the expectation
/// mean (I - T)^2.
struct NoisyError {
    double mse = 0;             ///< the estimate; may be below 0. NaN where no pixel counts
    double standard_error = 0;  ///< standard error of mse
    /// Bound on the root mean square shift that the encoding of noisy values causes in a reference's mean.
    double bias_rms = 0;
    /// Ends of the interval of the root mean square error, at two standard errors.
    [[nodiscard]] double least_rms() const;
    [[nodiscard]] double greatest_rms() const;
    /// True if the interval contains an error of zero. Only `greatest_rms` may be stated then.
    [[nodiscard]] bool is_bound() const { return !(least_rms() > 0); }
};

struct NoiseFloor {
    double reference_mse = 0;  ///< error of one reference, of sRGB values: mean (R1 - R2)^2 / 2
    /// The same of scene-linear values: as a root, and relative to M^2 + 0.01, M the mean of both references.
    double reference_rmse = 0, reference_relmse = 0;
    NoisyError encoded;   ///< error of the image above the noise, of sRGB values
    NoisyError linear;    ///< the same of scene-linear values
    NoisyError relative;  ///< the same of scene-linear values, relative to M^2 + 0.01
    /// (mean (I - R1)^2 - mean (I - R2)^2) / its standard error, of scene-linear values. It is standard
    /// normal if the references are equally good and the image is independent of both.
    double preference = 0;
};

/// Estimates over the pixels that `mask` counts, for images of one size. Standard errors come from blocks of
/// 16 x 16 pixels, or smaller ones if fewer than 64 such blocks would count. With A = I - R1 and B = I - R2,
/// the variance of a block's sum of AB is the expectation of (sum of A^2 - B^2)^2 / 4. This holds for
/// Gaussian errors that are independent between blocks, with any covariance within a block; errors with
/// longer tails make the standard errors too large. Details: docs/compare.md.
[[nodiscard]] NoiseFloor noise_floor(const Picture& image, const Picture& reference,
                                     const Picture& second_reference, const PixelMask& mask);

}  // namespace postlens
