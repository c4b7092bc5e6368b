// How good the reference itself is, and how large a picture's error is above that.
#pragma once

#include <cstddef>

#include "compare/pixel_errors.h"
#include "compare/pixel_mask.h"

namespace postlens {

/// A mean squared error that was estimated from noisy pictures. With R1 = T + e1 and R2 = T + e2, the truth T
/// and independent errors of mean 0, mean (I - R1)(I - R2) has the expectation mean (I - T)^2.
struct NoisyError {
    double mse = 0;             ///< the estimate; may be below 0. NaN where no pixel counts
    double standard_error = 0;  ///< of mse
    double bias_rms =
        0;  ///< bound on the root mean square by which an encoding shifts the mean of a reference
    /// What the truth lies between, as root mean square, at two standard errors.
    [[nodiscard]] double least_rms() const;
    [[nodiscard]] double greatest_rms() const;
    /// True where an error of zero is among what the data allow: then only `greatest_rms` may be claimed.
    [[nodiscard]] bool is_bound() const { return !(least_rms() > 0); }
};

struct NoiseFloor {
    double reference_mse = 0;  ///< of one reference, of encoded values: mean (R1 - R2)^2 / 2
    double reference_rmse = 0,
           reference_relmse = 0;  ///< the same, of scene-linear values, as root and relative
    NoisyError encoded;           ///< the picture's error above the noise, of encoded values
    NoisyError linear;            ///< of scene-linear values
    NoisyError relative;          ///< relative to M^2 + 0.01, M the mean of both references
    /// (mean (I - R1)^2 - mean (I - R2)^2) / its standard error, of scene-linear values. Normal with
    /// deviation 1 where the references are equally good and the picture was made without either of them.
    double preference = 0;
};

/// Estimates over the pixels that `mask` counts, for pictures of one size. Standard errors come from blocks
/// of 16 x 16 pixels (smaller where fewer than 64 such blocks would count): with A = I - R1 and B = I - R2, a
/// block's sum of AB has the variance that its (sum of A^2 - B^2)^2 / 4 has as expectation, for Gaussian
/// errors of any covariance within a block and none between blocks; errors with longer tails make it larger.
/// Details: docs/compare.md.
[[nodiscard]] NoiseFloor noise_floor(const Picture& image, const Picture& reference,
                                     const Picture& second_reference, const PixelMask& mask);

}  // namespace postlens
