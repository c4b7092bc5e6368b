// Counter-based random numbers. Each is a hash of a key and a counter, so they can be computed in any order.
#pragma once

#include <cstdint>

namespace postlens {

/// Number of samples that are computed together, so that the compiler vectorises the loops.
inline constexpr int sample_lanes = 16;

/// Mixes the bits of a 64-bit word with the finaliser of SplitMix64 [steele2014]. Different words give
/// different results.
[[nodiscard]] constexpr std::uint64_t mix64(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

/// Mixes the bits of a 32-bit word with a low-bias hash by C. Wellons. Different words give different
/// results.
[[nodiscard]] constexpr std::uint32_t mix32(std::uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7feb352dU;
    x = (x ^ (x >> 15)) * 0x846ca68bU;
    return x ^ (x >> 16);
}

[[nodiscard]] constexpr std::uint32_t low_word(std::uint64_t x) {
    return static_cast<std::uint32_t>(x);
}
[[nodiscard]] constexpr std::uint32_t high_word(std::uint64_t x) {
    return static_cast<std::uint32_t>(x >> 32);
}

/// Converts 24 bits to a float in [0, 1). The conversion is exact.
[[nodiscard]] constexpr float unit_float_24(std::int32_t bits) {
    return static_cast<float>(bits) * 0x1p-24F;
}
/// Converts the upper 24 bits of a word to a float in [0, 1).
[[nodiscard]] constexpr float unit_float(std::uint32_t word) {
    return unit_float_24(static_cast<std::int32_t>(word >> 8));
}

/// Returns random word number `counter` of the stream of `key`. All words of one stream are different.
[[nodiscard]] constexpr std::uint32_t random_word(std::uint64_t key, std::uint32_t counter) {
    return mix32(mix32(counter + low_word(key)) ^ high_word(key));
}

/// Random key for one set of sample points in one pixel. `stream` derives the keys of independent random
/// streams from it.
struct SetKey {
    std::uint64_t value;
    /// Random streams with different `purpose` are independent.
    [[nodiscard]] constexpr std::uint64_t stream(std::uint32_t purpose) const {
        return mix64(value + (purpose + 1ULL) * 0xd1b54a32d192ed03ULL);
    }
};

}  // namespace postlens
