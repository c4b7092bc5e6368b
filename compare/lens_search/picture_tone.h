// The tone that is compared when a lens is fitted to an image: luminance on a partly logarithmic scale.
#pragma once

#include <algorithm>
#include <cmath>

namespace postlens {

/// log(1 + Y / 0.18) for the Rec.709 luminance Y, where a negative Y counts as 0. The scale is linear in dark
/// areas, whose noise is uniform. Above middle grey it is logarithmic, so that bright light sources do not
/// dominate.
inline double picture_tone(double luminance) {
    constexpr double middle_grey = 0.18;
    return std::log1p(std::max(luminance, 0.0) / middle_grey);
}

/// Robust residual. Half its square is Huber's loss [huber1964], which grows linearly above `linear_from`.
inline double robust(double residual, double linear_from) {
    const double a = std::abs(residual);
    return a <= linear_from ? residual
                            : std::copysign(std::sqrt(linear_from * (2 * a - linear_from)), residual);
}

}  // namespace postlens
