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
    /// Upper bound of the bias of the estimate, as a root mean square over the values. The bias arises
    /// because the nonlinear sRGB encoding shifts the mean of noisy values.
    double bias_rms = 0;
    /// Ends of the confidence interval for the root mean square error of the image. They are two standard
    /// errors below and above the estimate, and the interval is widened by `bias_rms` on either side.
    [[nodiscard]] double least_rms() const;
    [[nodiscard]] double greatest_rms() const;
    /// Returns true if the interval includes zero. In this case the error is only known to be at most
    /// `greatest_rms`.
    [[nodiscard]] bool is_bound() const { return !(least_rms() > 0); }
};

struct NoiseFloor {
    double reference_mse = 0;  ///< error of one reference in sRGB values: mean (R1 - R2)^2 / 2
    /// RMSE and relMSE of one reference, in scene-linear values. For relMSE, the squared error is divided by
    /// M^2 + 0.01, where M is the mean of both references.
    double reference_rmse = 0, reference_relmse = 0;
    NoisyError encoded;   ///< error of the image apart from the noise, in sRGB values
    NoisyError linear;    ///< the same in scene-linear values
    NoisyError relative;  ///< the same in scene-linear values, divided by M^2 + 0.01
    /// Tells which reference the image is closer to. The value is positive if the image is closer to the
    /// second reference. It is the difference of the mean squared errors against the two references, divided
    /// by the standard error of this difference. The value has a standard normal distribution if both
    /// references are equally accurate and the image is independent of them.
    double preference = 0;
};

/// Estimates the errors over the pixels that `mask` counts. All images must have the same size. Standard
/// errors are computed from sums over blocks of 16 x 16 pixels, or over smaller blocks if there would be
/// fewer than 64 blocks. The standard errors are correct if the errors are Gaussian and independent between
/// blocks. They are too large if the distribution of errors has longer tails. docs/compare.md gives the
/// derivation.
[[nodiscard]] NoiseFloor noise_floor(const Picture& image, const Picture& reference,
                                     const Picture& second_reference, const PixelMask& mask);

}  // namespace postlens
