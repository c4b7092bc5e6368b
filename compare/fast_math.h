// Cube roots and powers of plain arithmetic: loops over them vectorise, and every machine gets the same bits.
#pragma once

#include <bit>
#include <cstdint>

namespace postlens {

/// Cube root of v > 1e-30 to 3e-7 of its value.
[[nodiscard]] inline float cube_root(float v) {
    // A third of the exponent, then twice Halley's step, which cubes the relative error (at first below
    // 0.06).
    auto r = std::bit_cast<float>(std::bit_cast<std::uint32_t>(v) / 3 + 709921077U);
    for (int i = 0; i < 2; ++i) {
        const float cube = r * r * r;
        r = r * (cube + 2 * v) / (2 * cube + v);
    }
    return r;
}

/// v^exponent for 0 <= v < 1e30 and 0 <= exponent <= 1, to 2e-6 of its value; 0 for v below 1e-30, whatever
/// the exponent.
[[nodiscard]] inline float power(float v, float exponent) {
    // log2: v = m 2^e with m in [sqrt(1/2), sqrt(2)), and log m = 2 artanh((m - 1) / (m + 1)), |argument| <
    // 0.172.
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(v) - 0x3f3504f3U;
    const auto e = static_cast<float>(static_cast<std::int32_t>(bits) >> 23);
    const auto m = std::bit_cast<float>((bits & 0x007fffffU) + 0x3f3504f3U);
    const float s = (m - 1) / (m + 1), ss = s * s;
    const float log2 =
        e +
        2.885390082F * s * (1 + ss * (0.333333333F + ss * (0.2F + ss * (0.142857143F + ss * 0.111111111F))));
    // exp2: whole and fractional part, the latter in [-1/2, 1/2], by its Taylor series. Added to 1.5 2^23, p
    // is rounded and stands in the low bits.
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
