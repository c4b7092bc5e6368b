#include "core/sobol.h"

#include <array>
#include <bit>
#include <cassert>

#include "core/multiversion.h"

namespace postlens {
namespace {

constexpr int index_bits = 32;
using Directions = std::array<std::uint32_t, index_bits>;

/// Primitive polynomial x^s + a_1 x^(s-1) + .. + 1 of one dimension of the Sobol sequence, and its first s
/// initial numbers m [joe2008, table "new-joe-kuo-6"]. The binary digits of `a` are a_1 .. a_(s-1).
struct Polynomial {
    int s;
    std::uint32_t a;
    std::array<std::uint32_t, 3> m;
};
constexpr std::array<Polynomial, 4> polynomials{
    {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}}}};

/// Returns the direction numbers of one dimension of the Sobol sequence, with their bits reversed. A point's
/// coordinate in this dimension is computed from them: it is the exclusive or of those direction numbers k
/// for which bit k of the point's index is 1.
constexpr Directions directions(int dimension) {
    Directions v{};
    if (dimension == 0) {  // van der Corput sequence: the index's bits, mirrored
        for (int k = 0; k < index_bits; ++k) v[static_cast<std::size_t>(k)] = 1U << k;
        return v;
    }
    const Polynomial p = polynomials[static_cast<std::size_t>(dimension - 1)];
    for (int k = 0; k < index_bits; ++k) {
        std::uint32_t word = 0;  // m_k * 2^(31 - k)
        if (k < p.s) {
            word = p.m[static_cast<std::size_t>(k)] << (31 - k);
        } else {
            const std::uint32_t before = v[static_cast<std::size_t>(k - p.s)];
            word = before ^ (before >> p.s);
            for (int j = 1; j < p.s; ++j)
                if (((p.a >> (p.s - 1 - j)) & 1) != 0) word ^= v[static_cast<std::size_t>(k - j)];
        }
        v[static_cast<std::size_t>(k)] = word;
    }
    for (std::uint32_t& word : v) word = reverse_bits(word);
    return v;
}

constexpr std::array<Directions, sobol_dimensions> all_directions{directions(0), directions(1), directions(2),
                                                                  directions(3), directions(4)};

constexpr std::uint32_t by_directions(const Directions& v, std::uint32_t index) {
    std::uint32_t x = 0;
    for (int k = 0; index != 0; ++k, index >>= 1)
        if ((index & 1) != 0) x ^= v[static_cast<std::size_t>(k)];
    return x;
}

/// Tables for the points of a Sobol sequence. Each bit of a point's index stands for a number, and the point
/// is the exclusive or of these numbers. `low` contains the results for the lower ten bits, `high` for the
/// next ten bits.
struct SplitTable {
    alignas(64) std::array<std::uint32_t, 1024> low, high;
};
SplitTable split_table(int dimension) {
    SplitTable t{};
    for (std::uint32_t i = 0; i < 1024; ++i) {
        t.low[i] = sobol_reversed(dimension, i);
        t.high[i] = sobol_reversed(dimension, i << 10);
    }
    return t;
}
const std::array<SplitTable, sobol_dimensions>& split_tables() {
    static const std::array<SplitTable, sobol_dimensions> tables{
        split_table(0), split_table(1), split_table(2), split_table(3), split_table(4)};
    return tables;
}

/// Returns dimension 1 of the Sobol sequence: Pascal's matrix modulo 2 times the vector of the index's bits.
/// This matrix is a product of five sparse matrices, and each line multiplies by one of them.
[[gnu::always_inline]] inline std::uint32_t pascal(std::uint32_t x) {
    x ^= (x >> 1) & 0x55555555U;
    x ^= (x >> 2) & 0x33333333U;
    x ^= (x >> 4) & 0x0f0f0f0fU;
    x ^= (x >> 8) & 0x00ff00ffU;
    return x ^ (x >> 16);
}

[[gnu::always_inline]] inline float scrambled(std::uint32_t x, std::uint32_t seed) {
    return unit_float(reverse_bits(owen_scramble_reversed(x, seed)));
}

/// Permutes the indices of samples randomly, so that independent random choices use the Sobol points in
/// different orders. The permutation keeps together each group of 2^j consecutive samples that begins at a
/// multiple of 2^j (nested uniform scramble). So each such group remains well distributed.
template <int lanes>
[[gnu::always_inline]] inline void shuffled(std::uint32_t seed, std::uint32_t reversed_mask, int first,
                                            std::uint32_t* index) {
    for (int i = 0; i < lanes; ++i) {
        const std::uint32_t x = reverse_bits(static_cast<std::uint32_t>(first + i));
        index[i] = reverse_bits(owen_scramble_reversed(x, seed) & reversed_mask);
    }
}

template <int lanes>
[[gnu::always_inline]] inline void padded(SetKey key, std::uint32_t reversed_mask, int first, float* u,
                                          float* v) {
    alignas(64) std::uint32_t index[lanes];
    const std::uint64_t seeds = key.stream(0);
    shuffled<lanes>(low_word(key.stream(1)), reversed_mask, first, index);
    for (int i = 0; i < lanes; ++i) u[i] = scrambled(index[i], low_word(seeds));
    if (v == nullptr) return;
    for (int i = 0; i < lanes; ++i) v[i] = scrambled(pascal(index[i]), high_word(seeds));
}

/// Coordinates of 16 consecutive Sobol points along one dimension, with their bits reversed. The coordinate
/// of point i is low[i] ^ high. low[i] depends on the lowest ten bits of the point's index, and `high` on the
/// other bits. These are the same for all 16 points, because the first index is a multiple of 16.
struct AlignedWords {
    const std::uint32_t* low;
    std::uint32_t high;
};
[[gnu::always_inline]] inline AlignedWords aligned_words(const SplitTable& t, std::uint32_t first) {
    return {t.low.data() + (first & 1023), t.high[(first >> 10) & 1023]};
}

template <int lanes>
[[gnu::always_inline]] inline void joint(const SplitTable& t, std::uint32_t seed, int first, float* u) {
    const auto begin = static_cast<std::uint32_t>(first);
    if (begin % lanes == 0) {
        const AlignedWords w = aligned_words(t, begin);
        for (int i = 0; i < lanes; ++i) u[i] = scrambled(w.low[i] ^ w.high, seed);
        return;
    }
    for (int i = 0; i < lanes; ++i) {
        const std::uint32_t index = begin + static_cast<std::uint32_t>(i);
        u[i] = scrambled(t.low[index & 1023] ^ t.high[(index >> 10) & 1023], seed);
    }
}

POSTLENS_MULTIVERSION void padded_16(SetKey key, std::uint32_t reversed_mask, int first, float* u, float* v) {
    padded<sample_lanes>(key, reversed_mask, first, u, v);
}
POSTLENS_MULTIVERSION void joint_16(const SplitTable& t, std::uint32_t seed, int first, float* u) {
    joint<sample_lanes>(t, seed, first, u);
}
POSTLENS_MULTIVERSION void joint_aligned_16(const SplitTable* t, const std::uint32_t* seeds,
                                            std::uint32_t first, float* const* u) {
    for (int d = 0; d < sobol_dimensions; ++d) {
        const AlignedWords w = aligned_words(t[d], first);
        const std::uint32_t seed = seeds[d];
        float* out = u[d];
        for (int i = 0; i < sample_lanes; ++i) out[i] = scrambled(w.low[i] ^ w.high, seed);
    }
}

}  // namespace

std::uint32_t sobol_reversed(int dimension, std::uint32_t index) {
    assert(dimension >= 0 && dimension < sobol_dimensions);
    return by_directions(all_directions[static_cast<std::size_t>(dimension)], index);
}

SobolPadding::SobolPadding(std::uint32_t n)
    : reversed_mask_(reverse_bits((1U << std::bit_width(n - 1)) - 1)) {
    assert(n >= 1 && n <= 1U << 20);
}
void SobolPadding::fill_2d(SetKey key, int first, int lanes, float* u, float* v) const {
    lanes == 1 ? padded<1>(key, reversed_mask_, first, u, v) : padded_16(key, reversed_mask_, first, u, v);
}
void SobolPadding::fill_1d(SetKey key, int first, int lanes, float* u) const {
    fill_2d(key, first, lanes, u, nullptr);
}

void sobol_joint(int dimension, std::uint32_t seed, int first, int lanes, float* u) {
    const SplitTable& t = split_tables()[static_cast<std::size_t>(dimension)];
    lanes == 1 ? joint<1>(t, seed, first, u) : joint_16(t, seed, first, u);
}

void sobol_joint_16(const std::array<std::uint32_t, sobol_dimensions>& seeds, int first,
                    const std::array<float*, sobol_dimensions>& u) {
    if (first % sample_lanes == 0)
        return joint_aligned_16(split_tables().data(), seeds.data(), static_cast<std::uint32_t>(first),
                                u.data());
    for (int d = 0; d < sobol_dimensions; ++d) {
        const auto k = static_cast<std::size_t>(d);
        sobol_joint(d, seeds[k], first, sample_lanes, u[k]);
    }
}

}  // namespace postlens
