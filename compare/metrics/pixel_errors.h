// Errors that are sums over pixels: RMSE, relMSE, PSNR.
#pragma once

#include <cstddef>

#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"

namespace postlens {

/// An image with its sRGB values, which are computed only once.
struct Picture {
    Image linear;   ///< scene-linear
    Image encoded;  ///< result of `encoded_srgb`
    Picture() = default;
    explicit Picture(Image image) : linear(std::move(image)), encoded(encoded_srgb(linear)) {}
};

/// Errors of an image against a reference. All are NaN if `mask` counts no pixel.
struct PixelErrors {
    double rmse = 0;            ///< root of the mean squared difference of scene-linear values
    double relmse = 0;          ///< mean of (a - b)^2 / (b^2 + 0.01), scene-linear [rousselle2011, sec. 4]
    double relmse_trimmed = 0;  ///< relmse without the floor(N/1000) worst of the N pixels
    /// 10 log10(1 / mean squared difference of sRGB values); infinite if there is no difference
    double psnr_db = 0;
    std::size_t pixels = 0;  ///< number N of pixels that count
};

/// This constant is added to b^2 in relMSE, so that the error of black pixels is not divided by zero.
inline constexpr double relmse_epsilon = 0.01;

/// Returns the errors of `image` against `reference` over the three channels of the pixels that `mask`
/// counts. Both have the same size. The counted pixels must be finite.
[[nodiscard]] PixelErrors pixel_errors(const Picture& image, const Picture& reference, const PixelMask& mask);

/// 10 log10(1 / mse), infinite for 0.
[[nodiscard]] double psnr_from_mse(double mse);

}  // namespace postlens
