// What is compared when a lens is fitted to a picture: luminance on a scale between linear and logarithmic.
#pragma once

#include <algorithm>
#include <cmath>

namespace postlens {

/// log(1 + Y / 0.18), Y the luminance (Rec.709), below 0 counted as 0: linear in the dark, where noise is
/// even, logarithmic above middle grey, so that lights do not decide alone.
inline double picture_tone(double luminance) {
    constexpr double middle_grey = 0.18;
    return std::log1p(std::max(luminance, 0.0) / middle_grey);
}

inline double luminance_of(const float* rgb) {
    return 0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
           0.0722 * static_cast<double>(rgb[2]);
}

/// Half its square is Huber's loss [huber1964]: beyond `linear_from` a residual counts linearly.
inline double robust(double residual, double linear_from) {
    const double a = std::abs(residual);
    return a <= linear_from ? residual
                            : std::copysign(std::sqrt(linear_from * (2 * a - linear_from)), residual);
}

}  // namespace postlens
