// The Sobol sequence and Owen's scramble, against slow and simple versions, and the properties of nets.
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/tracer/point_statistics.h"
#include "tracer/sampling/sampler.h"

namespace postlens::test::sobol_test {
namespace {

// Sobol's coordinates by definition: the digits of the index times a matrix. The matrix follows from the
// recurrence of the primitive polynomial x^s + a_1 x^(s-1) + ... + 1: m_k = 2 a_1 m_(k-1) ^ ... ^ 2^s m_(k-s)
// ^ m_(k-s).
double sobol_by_definition(int dimension, std::uint32_t index) {
    if (dimension == 0) {
        double x = 0;
        for (double digit = 0.5; index != 0; index >>= 1, digit /= 2) x += (index & 1) != 0 ? digit : 0;
        return x;
    }
    const std::vector<std::vector<int>> coefficients{{}, {1}, {0, 1}, {1, 0}};
    const std::vector<std::vector<std::uint64_t>> start{{1}, {1, 3}, {1, 3, 1}, {1, 1, 1}};
    const auto& a = coefficients[static_cast<std::size_t>(dimension - 1)];
    std::vector<std::uint64_t> m = start[static_cast<std::size_t>(dimension - 1)];
    const std::size_t s = m.size();
    for (std::size_t k = s; k < 24; ++k) {
        std::uint64_t next = m[k - s] << s ^ m[k - s];
        for (std::size_t j = 1; j < s; ++j)
            if (a[j - 1] != 0) next ^= m[k - j] << j;
        m.push_back(next);
    }
    std::uint64_t sum = 0;  // in units of 2^-24
    for (std::size_t k = 0; k < 24; ++k)
        if ((index >> k & 1) != 0) sum ^= m[k] << (24 - (k + 1));
    return static_cast<double>(sum) * 0x1p-24;
}

TEST(Sobol, AgreesWithTheDefinition) {
    for (int d = 0; d < sobol_dimensions; ++d) {
        for (std::uint32_t i = 0; i < 1U << 20; i = i < 300 ? i + 1 : i * 9 / 8)
            EXPECT_EQ(reverse_bits(sobol_reversed(d, i)) * 0x1p-32, sobol_by_definition(d, i))
                << d << ' ' << i;
    }
}

using Points = std::vector<std::pair<double, double>>;

// Checks that each elementary box of area 2^-m (2^a columns by 2^(m-a) rows) holds exactly one of 2^m points.
void expect_net(const Points& p, const std::string& what) {
    const int m = std::bit_width(p.size()) - 1;
    ASSERT_EQ(p.size(), std::size_t{1} << m);
    for (int a = 0; a <= m; ++a) {
        std::set<std::size_t> boxes;
        for (const auto& [u, v] : p)
            boxes.insert(cell_of(u, std::size_t{1} << a) + (cell_of(v, std::size_t{1} << (m - a)) << a));
        EXPECT_EQ(boxes.size(), p.size()) << what << ", " << a << " of " << m;
    }
}

// Each block of the unscrambled sequence is a (0,2) net in dimensions 0 and 1, and a (0,1) net in each
// dimension.
TEST(Sobol, IsANetInEveryBlock) {
    const auto x = [](int d, std::uint32_t i) { return reverse_bits(sobol_reversed(d, i)) * 0x1p-32; };
    for (const std::uint32_t n : {1U, 2U, 8U, 64U, 1024U}) {
        for (std::uint32_t block = 0; block < 5; ++block) {
            Points p;
            for (std::uint32_t i = block * n; i < (block + 1) * n; ++i) p.emplace_back(x(0, i), x(1, i));
            expect_net(p, "sequence");
            for (int d = 0; d < sobol_dimensions; ++d) {
                std::set<std::size_t> cells;
                for (std::uint32_t i = block * n; i < (block + 1) * n; ++i) cells.insert(cell_of(x(d, i), n));
                EXPECT_EQ(cells.size(), n) << d;
            }
        }
    }
}

TEST(Sobol, ScramblesAndShufflesKeepNets) {
    for (const int n : {1, 2, 4, 16, 64, 256, 1024}) {
        const Sampler s(SamplerKind::sobol, n, 5);
        for (std::uint32_t pixel = 0; pixel < 8; ++pixel) {
            for (const SampleSet set : {pixel_set, time_set, sample_set(3, 1, 4)}) {
                Points p;
                std::set<std::size_t> cells, lens_u, lens_v;
                for (int i = 0; i < n; ++i) {
                    const glm::vec2 q = s.point_2d(pixel, set, i), lens = s.point_2d(pixel, lens_set, i);
                    const auto count = static_cast<std::size_t>(n);
                    p.emplace_back(q.x, q.y);
                    cells.insert(cell_of(s.point_1d(pixel, set, i), count));
                    lens_u.insert(cell_of(lens.x, count)), lens_v.insert(cell_of(lens.y, count));
                }
                expect_net(p, "set " + std::to_string(set.id));
                for (const auto* c : {&cells, &lens_u, &lens_v})
                    EXPECT_EQ(c->size(), static_cast<std::size_t>(n));
            }
        }
    }
}

// If the number of samples is not a power of two, they are the first n of 2^k points in scrambled order. In
// each aligned block of 2^j samples, no two are in the same interval of 2^-j.
TEST(Sobol, AnyCountIsEvenInItsBlocks) {
    const Sampler s(SamplerKind::sobol, 100, 5);
    for (const SampleSet set : {time_set, sample_set(3, 1, 4)}) {
        for (const int block : {4, 16, 32}) {
            for (int begin = 0; begin + block <= 100; begin += block) {
                std::set<std::size_t> cells;
                for (int i = begin; i < begin + block; ++i)
                    cells.insert(cell_of(s.point_1d(2, set, i), static_cast<std::size_t>(block)));
                EXPECT_EQ(cells.size(), static_cast<std::size_t>(block));
            }
        }
    }
}

// Owen's scramble by definition: a random bit at each node of the binary tree flips the digit below it.
std::uint32_t owen_by_tree(std::uint32_t reversed, std::uint64_t seed) {
    std::uint32_t out = 0;
    for (unsigned bit = 0; bit < 32; ++bit) {
        const std::uint32_t above = reversed & ((1U << bit) - 1);
        const auto flip = static_cast<std::uint32_t>(mix64(mix64(seed + bit) ^ above) & 1);
        out |= ((reversed >> bit & 1) ^ flip) << bit;
    }
    return out;
}

TEST(OwenScramble, BitsDependOnlyOnThoseAbove) {
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const std::uint32_t seed = low_word(mix64(i)), x = low_word(mix64(i + 10000));
        for (unsigned bit = 0; bit < 32; ++bit) {
            const std::uint32_t change =
                owen_scramble_reversed(x, seed) ^ owen_scramble_reversed(x ^ 1U << bit, seed);
            // In the reversed word, this bit is flipped and no lower bit.
            ASSERT_EQ(change & ((2ULL << bit) - 1), 1ULL << bit);
        }
    }
}

// Each of the top 24 bits is flipped in half of all scrambles, independently at neighbouring nodes and bits.
// The share of N = 20000 scrambles has a standard error of 0.0035. The hash of five multiplications is not
// perfect, so the tolerance is 0.02 plus 4.5 standard errors.
TEST(OwenScramble, FlipsAreLikeThoseOfATree) {
    constexpr int scrambles = 20000;
    const double limit = 0.02 + 4.5 * 0.5 / std::sqrt(static_cast<double>(scrambles));
    for (const std::uint32_t x : {0U, 1U, 0x155U, 0xdeadbeefU}) {
        for (unsigned bit = 0; bit < 24; ++bit) {
            for (unsigned other = 0; other < bit; ++other) {
                int flips = 0, same_as_neighbour = 0, same_as_other_bit = 0;
                for (std::uint64_t k = 0; k < scrambles; ++k) {
                    const std::uint32_t seed = high_word(mix64(k));
                    const std::uint32_t flip = owen_scramble_reversed(x, seed) ^ x, y = x ^ 1U << other,
                                        neighbour = owen_scramble_reversed(y, seed) ^ y;
                    flips += static_cast<int>(flip >> bit & 1);
                    same_as_neighbour += static_cast<int>((~(flip ^ neighbour) >> bit) & 1);
                    same_as_other_bit += static_cast<int>((~(flip >> bit ^ flip >> other)) & 1);
                }
                EXPECT_NEAR(flips / static_cast<double>(scrambles), 0.5, limit) << bit;
                EXPECT_NEAR(same_as_neighbour / static_cast<double>(scrambles), 0.5, limit)
                    << bit << ' ' << other;
                EXPECT_NEAR(same_as_other_bit / static_cast<double>(scrambles), 0.5, limit)
                    << bit << ' ' << other;
            }
        }
    }
}

// The low eight of 24 bits of scrambled points are uniform over pixels, by a chi-square with 255 degrees of
// freedom and a standard deviation of 22.6. (Within a pixel they may be more uniform than random.)
TEST(OwenScramble, LowBitsAreUniform) {
    const Sampler s(SamplerKind::sobol, 64, 5);
    for (const int index : {0, 1, 37}) {
        std::vector<int> u(256), v(256), t(256);
        for (std::uint32_t p = 0; p < 50000; ++p) {
            const glm::vec2 x = s.point_2d(p, lens_set, index), y = s.point_2d(p, sample_set(0, 0, 0), index);
            ++u[static_cast<unsigned>(x.x * 0x1p24F) & 255U];
            ++v[static_cast<unsigned>(y.y * 0x1p24F) & 255U];
            ++t[static_cast<unsigned>(s.point_1d(p, time_set, index) * 0x1p24F) & 255U];
        }
        for (const auto* counts : {&u, &v, &t}) EXPECT_LT(chi_square(*counts), 255 + 4.5 * 22.6) << index;
    }
}

// The mean squared error of the mean of exp over n scrambled points must be equal for the hash and the tree.
// Each is a sum of N = 4000 nearly normal squared errors with a relative error of sqrt(2 / N). Their ratio
// has an error of 0.032, and the tolerance is 4.5 of these, 0.14.
TEST(OwenScramble, HasTheErrorOfATree) {
    constexpr int scrambles = 4000;
    for (const std::uint32_t n : {4U, 16U, 64U}) {
        for (int d = 0; d < sobol_dimensions; ++d) {
            double by_hash = 0, by_tree = 0;
            for (std::uint64_t k = 0; k < scrambles; ++k) {
                double hash_sum = 0, tree_sum = 0;
                for (std::uint32_t i = 0; i < n; ++i) {
                    const std::uint32_t x = sobol_reversed(d, i);
                    hash_sum +=
                        std::exp(unit_float(reverse_bits(owen_scramble_reversed(x, low_word(mix64(k))))));
                    tree_sum += std::exp(unit_float(reverse_bits(owen_by_tree(x, mix64(k)))));
                }
                by_hash += std::pow(hash_sum / n - std::expm1(1.0), 2);
                by_tree += std::pow(tree_sum / n - std::expm1(1.0), 2);
            }
            EXPECT_NEAR(by_hash / by_tree, 1, 0.14) << n << ' ' << d;
            // With one uniform, independent point per interval of 1/n, the variance is that of exp in the
            // intervals. There exp is nearly linear, which gives (e^2 - 1) / 24 / n^3; the next term is below
            // 1/n^2 of it.
            EXPECT_NEAR(by_tree / scrambles * 24 * std::pow(n, 3) / std::expm1(2.0), 1, 0.1 + 1.0 / (n * n))
                << n;
        }
    }
}

}  // namespace
}  // namespace postlens::test::sobol_test
