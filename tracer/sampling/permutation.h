// Random permutations of 0 .. n - 1. Each element is computed independently of the others.
#pragma once

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>

#include "core/sample_hash.h"

namespace postlens {

/// A random permutation of 0 .. n - 1, for any n in 1 .. 2^30, selected by `key`.
/// A bijection of b-bit numbers, where 2^b >= n, is applied until the result is less than n.
class Permutation {
  public:
    Permutation(std::uint32_t n, std::uint64_t key) : n_(n) {
        assert(n >= 1 && n <= 1U << 30);
        const int bits = std::bit_width(n - 1);
        mask_ = (1U << bits) - 1;
        for (std::uint32_t r = 0; r < rounds; ++r) {
            const std::uint64_t word = mix64(key + r);
            multiplier_[r] = low_word(word) | 1;
            offset_[r] = high_word(word);
            // Chooses by how many bits round r shifts. A number is permuted in several rounds: each one
            // multiplies it, adds offset_[r], and combines the result with a copy of itself that is shifted
            // right by shift_[r] bits. Since only the lowest `bits` bits of a number count, the highest bits
            // of offset_[r] mostly have no effect on it. Therefore, the highest 4 bits can be used a second
            // time, to choose the shift.
            shift_[r] =
                1 + static_cast<int>((offset_[r] >> 28) * static_cast<unsigned>(std::max(bits - 1, 1)) >> 4);
        }
    }

    /// Returns the image of x, which must be in [0, n).
    [[nodiscard]] std::uint32_t at(std::uint32_t x) const {
        assert(x < n_);
        permute<1>(&x);
        return x;
    }

    /// Replaces each of the `lanes` integers x, in [0, n), by its image under the random permutation. step()
    /// permutes the integers in [0, 2^k), the smallest such range that contains [0, n). So its result may be
    /// n or more. Then step() is applied to this result again, until the result is less than n (cycle
    /// walking).
    template <int lanes>
    [[gnu::always_inline]] void permute(std::uint32_t* x) const {
        bool walking = step<lanes>(x, true);
        while (walking) walking = step<lanes>(x, false);
    }

  private:
    template <int lanes>
    [[gnu::always_inline]] bool step(std::uint32_t* x, bool all) const {
        std::uint32_t outside = 0;
        const std::uint32_t n = all ? 0 : n_;
        for (int i = 0; i < lanes; ++i) {
            std::uint32_t y = x[i];
            for (std::uint32_t r = 0; r < rounds; ++r) {
                y = (y * multiplier_[r] + offset_[r]) & mask_;
                y ^= y >> shift_[r];
            }
            x[i] = x[i] >= n ? y : x[i];
            outside |= x[i] >= n_ ? 1 : 0;
        }
        return outside != 0;
    }

    /// Number of rounds in which a number is permuted. Each round multiplies, adds and shifts. More rounds
    /// make the permutations more random: with six rounds, all permutations of 2 to 5 elements are equally
    /// frequent, within 4 %. With four rounds, their frequencies would differ by tens of percent.
    static constexpr std::uint32_t rounds = 6;
    std::uint32_t n_, mask_ = 0;
    std::uint32_t multiplier_[rounds] = {}, offset_[rounds] = {};
    int shift_[rounds] = {};
};

}  // namespace postlens
