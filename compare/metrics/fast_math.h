// Cube root and power in basic arithmetic, which compilers vectorise. Results are bit-identical on all
// machines.
#pragma once

#include <bit>
#include <cstdint>

namespace postlens {

/// Returns the cube root of v > 1e-30, with a relative error of at most 3e-7.
[[nodiscard]] inline float cube_root(float v) {
    // The first estimate of the cube root divides the float's exponent by 3, with an error below 0.06. Each
    // Halley step cubes the error.
    auto r = std::bit_cast<float>(std::bit_cast<std::uint32_t>(v) / 3 + 709921077U);
    for (int i = 0; i < 2; ++i) {
        const float cube = r * r * r;
        r = r * (cube + 2 * v) / (2 * cube + v);
    }
    return r;
}

/// Returns v^exponent for 0 <= v < 1e30 and 0 <= exponent <= 1, or 0 for v <= 1e-30. The relative error is at
/// most 2e-6.
[[nodiscard]] inline float power(float v, float exponent) {
    // Computes log2(v). The float v is m 2^e, where e is an integer and m is in [sqrt(1/2), sqrt(2)), so
    // log2(v) = e + log2(m). The logarithm of m comes from a series: ln(m) = 2 artanh(s), with s = (m - 1) /
    // (m + 1).
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(v) - 0x3f3504f3U;
    const auto e = static_cast<float>(static_cast<std::int32_t>(bits) >> 23);
    const auto m = std::bit_cast<float>((bits & 0x007fffffU) + 0x3f3504f3U);
    const float s = (m - 1) / (m + 1), ss = s * s;
    const float log2 =
        e +
        2.885390082F * s * (1 + ss * (0.333333333F + ss * (0.2F + ss * (0.142857143F + ss * 0.111111111F))));
    // Computes exp2(p) from the integer part of p and a Taylor series of the rest. To split p, `rounder` =
    // 1.5 * 2^23 is added. A float of this size has no bits for fractions, so the addition rounds p to an
    // integer, in the low bits of `shifted`.
    constexpr float rounder = 12582912.0F;
    const float p = exponent * log2, shifted = p + rounder;
    const float f = (p - (shifted - rounder)) * 0.693147181F;
    const float fraction =
        1 + f * (1 + f * (0.5F + f * (0.166666667F +
                                      f * (0.0416666667F + f * (0.00833333333F + f * 0.00138888889F)))));
    const float result =
        fraction * std::bit_cast<float>((std::bit_cast<std::uint32_t>(shifted) + 127U) << 23U);
    return v > 1e-30F ? result : 0.0F;
}

}  // namespace postlens
