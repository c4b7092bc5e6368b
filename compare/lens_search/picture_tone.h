// Brightness scale (tone) on which images are compared when a lens is fitted to a given image. Each image
// that is computed for a lens is converted to this scale and compared with the given image.
#pragma once

#include <algorithm>
#include <cmath>

namespace postlens {

/// Returns log(1 + Y / 0.18) for the Rec.709 luminance Y >= 0. In dark areas, where noise is uniform, this is
/// nearly proportional to Y. The logarithm keeps bright lights from dominating.
inline double picture_tone(double luminance) {
    constexpr double middle_grey = 0.18;
    return std::log1p(std::max(luminance, 0.0) / middle_grey);
}

/// Limits the influence of outliers on a least-squares fit: residuals above `linear_from` count linearly. The
/// square of the returned residual is twice the Huber loss [huber1964].
inline double robust(double residual, double linear_from) {
    const double a = std::abs(residual);
    return a <= linear_from ? residual
                            : std::copysign(std::sqrt(linear_from * (2 * a - linear_from)), residual);
}

}  // namespace postlens
