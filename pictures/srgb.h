// The sRGB transfer curve, between scene-linear values and the encoded values of 8-bit images. Also the
// luminance of a colour with sRGB primaries.
#pragma once

#include <cmath>

namespace postlens {

/// Converts a linear value to an sRGB value [iec61966-2-1], clamped to 0..1. NaN becomes 0.
[[nodiscard]] inline float srgb_from_linear(float v) {
    if (!(v > 0)) return 0;
    if (v >= 1) return 1;
    return v <= 0.0031308F ? 12.92F * v : 1.055F * std::pow(v, 1 / 2.4F) - 0.055F;
}

/// Returns the derivative of the sRGB transfer curve at a linear value from 0 to 1.
[[nodiscard]] inline double srgb_slope(double linear) {
    return linear <= 0.0031308 ? 12.92 : 1.055 / 2.4 * std::pow(linear, 1 / 2.4 - 1);
}

/// Converts an sRGB value, which must not be negative, to a linear value [iec61966-2-1].
[[nodiscard]] inline float linear_from_srgb(float v) {
    return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
}

/// Returns the luminance of linear values, or the luma of encoded values [itu-bt709].
template <typename Value>
[[nodiscard]] Value luminance(Value r, Value g, Value b) {
    return static_cast<Value>(0.2126) * r + static_cast<Value>(0.7152) * g + static_cast<Value>(0.0722) * b;
}
[[nodiscard]] inline float luminance(const float* rgb) {
    return luminance(rgb[0], rgb[1], rgb[2]);
}
/// Returns the luminance in double precision, to avoid rounding errors in sums.
[[nodiscard]] inline double exact_luminance(const float* rgb) {
    return luminance(static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2]));
}

}  // namespace postlens
