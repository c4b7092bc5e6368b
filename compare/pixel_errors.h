// Errors that are sums over pixels: RMSE, relMSE, PSNR.
#pragma once

#include <cstddef>

#include "compare/pixel_mask.h"
#include "records/image.h"

namespace postlens {

/// A picture with its encoded form, computed once.
struct Picture {
    Image linear;   ///< scene-linear
    Image encoded;  ///< as `encoded_srgb` gives it
    Picture() = default;
    explicit Picture(Image image) : linear(std::move(image)), encoded(encoded_srgb(linear)) {}
};

/// NaN throughout where no pixel counts.
struct PixelErrors {
    double rmse = 0;            ///< root of the mean squared difference of scene-linear values
    double relmse = 0;          ///< mean of (a - b)^2 / (b^2 + 0.01), scene-linear [rousselle2011, sec. 4]
    double relmse_trimmed = 0;  ///< the same without the floor(N/1000) worst of the N pixels
    double psnr_db = 0;  ///< 10 log10(1 / mean squared difference of encoded values); infinite: no difference
    std::size_t pixels = 0;  ///< N
};

/// What is added to b^2 in relMSE, so that black pixels do not divide by zero.
inline constexpr double relmse_epsilon = 0.01;

/// Errors of `image` against `reference`, of one size, over the pixels that `mask` counts (those must be
/// finite) and their three channels.
[[nodiscard]] PixelErrors pixel_errors(const Picture& image, const Picture& reference, const PixelMask& mask);

/// 10 log10(1 / mse), infinite for 0.
[[nodiscard]] double psnr_from_mse(double mse);

}  // namespace postlens
