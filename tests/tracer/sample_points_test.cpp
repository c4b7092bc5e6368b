// The parts of samplers: hashes, permutations, cells of equal area, Poisson-disc patterns, the Sobol sequence
// and its scramble, each compared with a slow and simple version.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "tests/tracer/point_statistics.h"
#include "tracer/sampling/permutation.h"
#include "tracer/sampling/sampler.h"

namespace postlens::test::sample_points_test {
namespace {

TEST(SampleHash, FloatsStayBelowOne) {
    EXPECT_EQ(unit_float(0xffffffffU), 1 - 0x1p-24F);
    EXPECT_EQ(unit_float(0), 0);
    EXPECT_EQ(unit_float(0x80000000U), 0.5F);
}

// Each input bit flips each output bit in half of all cases. The standard error of a share of N cases is
// 1 / (2 sqrt N).
TEST(SampleHash, EveryBitMatters) {
    constexpr std::uint32_t tries = 20000;
    for (int in = 0; in < 64; ++in) {
        std::vector<int> flips(64), narrow_flips(32);
        for (std::uint64_t i = 0; i < tries; ++i) {
            const std::uint64_t x = mix64(i * 3 + 1), change = mix64(x) ^ mix64(x ^ 1ULL << in);
            for (unsigned out = 0; out < 64; ++out) flips[out] += static_cast<int>(change >> out & 1);
            const std::uint32_t narrow = random_word(x, 5) ^ random_word(x ^ 1ULL << in, 5);
            for (unsigned out = 0; out < 32; ++out) narrow_flips[out] += static_cast<int>(narrow >> out & 1);
        }
        for (const int f : flips) EXPECT_NEAR(f, tries / 2.0, 5 * std::sqrt(tries) / 2) << in;
        // The keyed 32-bit word is a weaker hash, with shares within 0.03 of one half.
        for (const int f : narrow_flips) EXPECT_NEAR(f / static_cast<double>(tries), 0.5, 0.03) << in;
    }
}

TEST(Permutation, IsOneForEveryLength) {
    std::vector<std::uint32_t> lengths(200);
    std::iota(lengths.begin(), lengths.end(), 1U);
    for (const std::uint32_t n : {1000U, 1023U, 1024U, 1025U, 65537U, 1U << 20}) lengths.push_back(n);
    for (const std::uint32_t n : lengths) {
        for (std::uint64_t key = 0; key < (n > 200 ? 2U : 20U); ++key) {
            const Permutation p(n, mix64(key));
            std::vector<bool> seen(n);
            for (std::uint32_t i = 0; i < n; ++i) {
                const std::uint32_t at = p.at(i);
                ASSERT_LT(at, n);
                ASSERT_FALSE(seen[at]) << n << ' ' << i;
                seen[at] = true;
            }
        }
    }
}

TEST(Permutation, LanesAgreeWithOneAtATime) {
    for (const std::uint32_t n : {1U, 2U, 17U, 33U, 100U, 4097U}) {
        const Permutation p(n, 99);
        std::uint32_t x[16];
        for (std::uint32_t i = 0; i < 16; ++i) x[i] = i * 7 % n;
        p.permute<16>(x);
        for (std::uint32_t i = 0; i < 16; ++i) EXPECT_EQ(x[i], p.at(i * 7 % n)) << n;
    }
}

// For small n, all n! permutations are equally frequent. The test is a chi-square with n! - 1 degrees of
// freedom.
TEST(Permutation, AllComeEquallyOften) {
    for (const std::uint32_t n : {2U, 3U, 4U, 5U}) {
        std::map<std::vector<std::uint32_t>, int> counts;
        std::size_t all = 1;
        for (std::uint32_t k = 2; k <= n; ++k) all *= k;
        for (std::uint64_t key = 0; key < 200 * all; ++key) {
            const Permutation p(n, mix64(key));
            std::vector<std::uint32_t> v(n);
            for (std::uint32_t i = 0; i < n; ++i) v[i] = p.at(i);
            ++counts[v];
        }
        ASSERT_EQ(counts.size(), all);
        std::vector<int> c;
        for (const auto& [order, count] : counts) c.push_back(count);
        const double freedom = static_cast<double>(all) - 1;
        EXPECT_LT(chi_square(c), freedom + 4.5 * std::sqrt(2 * freedom)) << n;
    }
}

// For larger n, the positions of two elements are uniform over ordered pairs.
TEST(Permutation, PairsOfPlacesAreUniform) {
    for (const std::uint32_t n : {16U, 23U, 32U}) {
        for (const std::uint32_t second : {1U, 2U, 8U, n - 1}) {
            std::vector<int> counts(static_cast<std::size_t>(n) * n);
            const std::uint32_t keys = 100 * n * n;
            for (std::uint64_t key = 0; key < keys; ++key) {
                const Permutation p(n, mix64(key));
                ++counts[p.at(0) * n + p.at(second)];
            }
            std::vector<int> pairs;
            for (std::uint32_t a = 0; a < n; ++a) {
                for (std::uint32_t b = 0; b < n; ++b)
                    if (a != b) pairs.push_back(counts[a * n + b]);
            }
            EXPECT_EQ(std::accumulate(pairs.begin(), pairs.end(), 0U), keys);
            const double freedom = static_cast<double>(pairs.size()) - 1;
            EXPECT_LT(chi_square(pairs), freedom + 4.5 * std::sqrt(2 * freedom)) << n << ' ' << second;
        }
    }
}

// Finds the cell of each point with exact integers: its row, then its column.
TEST(Strata, OnePointInEachCellOfEqualArea) {
    for (const int n : {1, 2, 3, 7, 16, 17, 64, 1000, 1021}) {
        const Strata strata(static_cast<std::uint32_t>(n));
        EXPECT_EQ(strata.row_begin(strata.rows()), static_cast<std::uint32_t>(n));
        for (const SamplerKind kind : {SamplerKind::grid, SamplerKind::jittered}) {
            const Sampler s(kind, n, 5);
            for (const SampleSet set : {pixel_set, lens_set, sample_set(1, 1, 1)}) {
                std::set<std::uint64_t> cells, intervals;
                for (int i = 0; i < n; ++i) {
                    const glm::vec2 p = s.point_2d(31, set, i);
                    // Points are exact multiples of 2^-24, so cells are found with integers.
                    const auto v = static_cast<std::uint64_t>(p.y * 0x1p24F) * static_cast<unsigned>(n);
                    std::uint32_t row = 0;
                    while (static_cast<std::uint64_t>(strata.row_begin(row + 1)) << 24 <= v) ++row;
                    const std::uint32_t begin = strata.row_begin(row),
                                        count = strata.row_begin(row + 1) - begin;
                    const auto column = static_cast<std::uint64_t>(p.x * 0x1p24F) * count >> 24;
                    cells.insert(begin + column);
                    if (set.id == pixel_set.id) {
                        EXPECT_EQ(begin + column, static_cast<std::uint64_t>(i));
                    }
                    if (kind == SamplerKind::grid) {
                        // Centres are exact to one step of 2^-24.
                        EXPECT_NEAR(p.x * count, static_cast<double>(column) + 0.5, 0x1p-23 * count);
                        EXPECT_NEAR(p.y * static_cast<double>(n), begin + 0.5 * count, 0x1p-23 * n);
                    }
                    const auto t = static_cast<std::uint64_t>(s.point_1d(31, set, i) * 0x1p24F);
                    intervals.insert(t * static_cast<unsigned>(n) >> 24);
                }
                EXPECT_EQ(cells.size(), static_cast<std::size_t>(n)) << name_of(kind);
                EXPECT_EQ(intervals.size(), static_cast<std::size_t>(n)) << name_of(kind);
            }
        }
    }
}

// With so many cells that each is only 16 or 17 steps of 2^-24 wide in one dimension, sample i is still in
// cell i.
TEST(Strata, ManyCellsKeepTheirPoints) {
    for (const std::uint32_t n : {65537U, 999983U, 1U << 20}) {
        const Strata strata(n);
        const Sampler s(SamplerKind::jittered, static_cast<int>(n), 5);
        std::vector<bool> seen(n);
        std::uint32_t row = 0, wrong = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
            while (strata.row_begin(row + 1) <= i) ++row;
            const std::uint64_t begin = strata.row_begin(row), end = strata.row_begin(row + 1);
            const glm::vec2 p = s.point_2d(31, pixel_set, static_cast<int>(i));
            const std::uint64_t v = static_cast<std::uint64_t>(p.y * 0x1p24F) * n;
            wrong += static_cast<std::uint64_t>(p.x * 0x1p24F) * (end - begin) >> 24 != i - begin ? 1 : 0;
            wrong += v < begin << 24 || v >= end << 24 ? 1 : 0;
            const float t = s.point_1d(31, time_set, static_cast<int>(i));
            seen[static_cast<std::uint64_t>(t * 0x1p24F) * n >> 24] = true;
        }
        EXPECT_EQ(wrong, 0U) << n;
        EXPECT_EQ(std::count(seen.begin(), seen.end(), true), n);
    }
}

TEST(Strata, CellsAreNearlySquare) {
    for (std::uint32_t n = 1; n <= 3000; ++n) {
        const Strata s(n);
        for (std::uint32_t r = 0; r < s.rows(); ++r) {
            const double count = s.row_begin(r + 1) - s.row_begin(r);
            const double aspect = count * count / n;  // height over width
            // The worst case is n = 3, with a row of one cell above a row of two cells.
            EXPECT_GE(aspect, 1.0 / 3) << n;
            EXPECT_LE(aspect, 2) << n;
        }
    }
}

double least_distance(const std::vector<double>& u, const std::vector<double>& v) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < u.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            const double du = std::remainder(u[i] - u[k], 1), dv = std::remainder(v[i] - v[k], 1);
            least = std::min(least, std::hypot(du, dv));
        }
    }
    return least;
}

TEST(Poisson, PointsKeepTheirDistanceOnTheTorus) {
    for (const int n : {2, 3, 4, 5, 7, 16, 64, 257, 1024}) {
        const Sampler s(SamplerKind::poisson, n, 3);
        for (std::uint32_t pixel = 0; pixel < (n > 100 ? 4U : 40U); ++pixel) {
            std::vector<double> u, v, t, zero;
            for (int i = 0; i < n; ++i) {
                const glm::vec2 p = s.point_2d(pixel, lens_set, i);
                u.push_back(p.x), v.push_back(p.y), t.push_back(s.point_1d(pixel, time_set, i)),
                    zero.push_back(0);
            }
            // Rounding to 2^-24 moves each of two points by less than sqrt(2) 2^-24 towards the other.
            EXPECT_GE(least_distance(u, v), 0.7 * densest_distance(n) - 0x1p-22) << n;
            EXPECT_GE(least_distance(t, zero), 0.7 / n - 0x1p-23) << n;
        }
    }
}

// A pattern is found for every number of points, and different seeds give different patterns.
TEST(Poisson, EveryCountUpToABlockIsReached) {
    for (int n = 1; n <= PoissonPoints::max_block; n = n < 130 ? n + 1 : n * 5 / 4) {
        const PoissonPattern p = poisson_pattern(n, 17), q = poisson_pattern(n, 18);
        EXPECT_EQ(p.u.size(), static_cast<std::size_t>(n));
        EXPECT_EQ(p.v.size(), static_cast<std::size_t>(n));
        if (n > 1) {
            EXPECT_NE(p.u, q.u);
        }
    }
}

// 2500 samples are divided into blocks of 834, 833 and 833, each of which keeps its minimum distance.
TEST(Poisson, MoreThanABlockIsSeveral) {
    constexpr int n = 2500;
    const Sampler s(SamplerKind::poisson, n, 3);
    int begin = 0;
    for (const int size : {834, 833, 833}) {
        std::vector<double> u, v;
        for (int i = begin; i < begin + size; ++i) {
            const glm::vec2 p = s.point_2d(8, lens_set, i);
            u.push_back(p.x), v.push_back(p.y);
        }
        EXPECT_GE(least_distance(u, v), 0.7 * densest_distance(size) - 0x1p-22);
        begin += size;
    }
    EXPECT_EQ(begin, n);
}

}  // namespace
}  // namespace postlens::test::sample_points_test
