// Errors that are sums over pixels: RMSE, relMSE and PSNR.
#pragma once

#include <cstddef>

#include "compare/metrics/pixel_mask.h"
#include "pictures/image.h"

namespace postlens {

/// An image and its sRGB values, which are computed only once.
struct Picture {
    Image linear;   ///< scene-linear
    Image encoded;  ///< result of `encoded_srgb`
    Picture() = default;
    explicit Picture(Image image) : linear(std::move(image)), encoded(encoded_srgb(linear)) {}
};

/// Errors of an image against a reference. All are NaN if `mask` counts no pixel.
struct PixelErrors {
    double rmse = 0;            ///< root of the mean squared difference, scene-linear
    double relmse = 0;          ///< mean of (a - b)^2 / (b^2 + 0.01), scene-linear [rousselle2011, sec. 4]
    double relmse_trimmed = 0;  ///< relmse without the floor(N/1000) pixels of largest error, of N pixels
    /// 10 log10(1 / mean squared difference of sRGB values); infinite for equal images
    double psnr_db = 0;
    std::size_t pixels = 0;  ///< number N of compared pixels
};

/// relMSE divides by b^2 plus this constant, where b is the reference, so that black pixels have a finite
/// error.
inline constexpr double relmse_epsilon = 0.01;

/// Returns the errors of `image` over the pixels that `mask` counts. In these pixels, both images must be
/// finite. Both images must have the same size.
[[nodiscard]] PixelErrors pixel_errors(const Picture& image, const Picture& reference, const PixelMask& mask);

/// Returns 10 log10(1 / mse). Returns infinity if `mse` is 0.
[[nodiscard]] double psnr_from_mse(double mse);

}  // namespace postlens
