// The brightness scale (tone) on which images are compared when a lens is fitted. It is nearly linear in the
// luminance for dark pixels, and logarithmic for bright ones.
#pragma once

#include <algorithm>
#include <cmath>

namespace postlens {

/// Returns log(1 + Y / 0.18) for the Rec.709 luminance Y. A negative Y counts as 0. The scale is nearly
/// linear in dark areas, where noise is uniform. It is logarithmic above middle grey, so that bright light
/// sources do not dominate.
inline double picture_tone(double luminance) {
    constexpr double middle_grey = 0.18;
    return std::log1p(std::max(luminance, 0.0) / middle_grey);
}

/// Returns a robust residual, which limits the influence of outliers. Half its square is Huber's loss
/// [huber1964], which grows linearly above `linear_from`.
inline double robust(double residual, double linear_from) {
    const double a = std::abs(residual);
    return a <= linear_from ? residual
                            : std::copysign(std::sqrt(linear_from * (2 * a - linear_from)), residual);
}

}  // namespace postlens
