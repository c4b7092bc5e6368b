// Owen-scrambled Sobol points, the sample points of a pixel.
#pragma once

#include <array>
#include <cstdint>

#include "core/sample_hash.h"

namespace postlens {

inline constexpr int sobol_dimensions = 5;

/// Returns coordinate `dimension` (0 .. 4) of Sobol point `index` [joe2008], with its bits reversed. Bit 0 of
/// the result is therefore worth 1/2, bit 1 is worth 1/4, and so on.
[[nodiscard]] std::uint32_t sobol_reversed(int dimension, std::uint32_t index);

[[nodiscard]] constexpr std::uint32_t reverse_bits(std::uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x >> 4) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4);
    x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
    return ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
}

/// Scrambles a bit-reversed number by a nested uniform scramble [owen1995], computed by a hash [laine2011,
/// burley2020]. The multipliers are from N. Vegdahl, "Building a better LK hash" (2021).
[[nodiscard]] constexpr std::uint32_t owen_scramble_reversed(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeaU;
    x += seed;
    x *= (seed >> 16) | 1;
    x ^= x * 0x05526c56U;
    return x ^ x * 0x53a22864U;
}

// The position in the pixel (two numbers), the lens point (two) and the time of an eye ray come from one
// five-dimensional Sobol sequence. The alternative is three sequences that are shuffled separately. With 1024
// samples per pixel, one sequence has half the error of these.

/// Computes coordinate number `dimension` (0 to 4) of several points of the five-dimensional Sobol sequence,
/// scrambled with `seed`, and writes it to `u`. The points are first .. first + lanes - 1, where `lanes` is
/// 16 or 1. first + lanes is at most 2^20, the length of the tables.
void sobol_joint(int dimension, std::uint32_t seed, int first, int lanes, float* u);
/// Writes all coordinates of samples first .. first + 15 of the five-dimensional sequence, scrambled with
/// `seeds`.
void sobol_joint_16(const std::array<std::uint32_t, sobol_dimensions>& seeds, int first,
                    const std::array<float*, sobol_dimensions>& u);

/// One- and two-dimensional sample points from shuffled Sobol sequences [burley2020], for random choices
/// other than the pixel position, the lens point and the time, such as points on area lights. The functions
/// write the points of `lanes` consecutive samples of a pixel, beginning with sample `first`. `lanes` is 16
/// or 1.
class SobolPadding {
  public:
    /// `n` is the number of samples of a pixel, 1 .. 2^20. Let 2^k be the smallest power of two not less than
    /// n. Sample i uses the Sobol point p(i), where p is a random permutation of 0 .. 2^k - 1.
    explicit SobolPadding(std::uint32_t n);
    void fill_2d(SetKey key, int first, int lanes, float* u, float* v) const;  ///< a (0,2)-sequence
    void fill_1d(SetKey key, int first, int lanes, float* u) const;            ///< a (0,1)-sequence

  private:
    std::uint32_t reversed_mask_;  ///< mask of the k bits of an index, bit-reversed
};

}  // namespace postlens
