// Poisson-disc points on the torus: random points with a minimum distance from each other [cook1986].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/sample_hash.h"

namespace postlens {

/// A pattern of points in [0, 1)^2, in units of 2^-32, so that the sum with a shift wraps around the torus.
struct PoissonPattern {
    std::vector<std::uint32_t> u, v;
};

/// The distance of neighbours in the densest (hexagonal) arrangement of points on the plane, one per area
/// 1/n: sqrt(2 / (sqrt(3) n)).
[[nodiscard]] double densest_distance(int n);

/// Exactly n points, 1 .. 1024, of which no two are nearer than `poisson_distance_share` *
/// densest_distance(n) on the torus. Random points are tried until n of them keep the distance. A pattern
/// that leaves no room before that is started anew.
[[nodiscard]] PoissonPattern poisson_pattern(int n, std::uint64_t seed);
/// Minimum distance of points, relative to that of the densest arrangement. Random points leave no room for
/// another when their discs cover 0.547 of the area, which corresponds to 0.777. At 0.7, one random point in
/// a hundred still finds room as the last point.
inline constexpr double poisson_distance_share = 0.7;

/// n points on the circle [0, 1), none nearer to another than poisson_distance_share / n. Independent uniform
/// points are placed on the length that remains without the minimum distances, which gives the exact
/// distribution of random points with that minimum distance.
[[nodiscard]] std::vector<std::uint32_t> poisson_circle(int n, std::uint64_t seed);

/// Points of a pixel: one of `patterns` patterns, shifted at random on the torus, in random order. More than
/// 1024 samples are divided into independent blocks of nearly equal size, each of at most 1024 points.
class PoissonPoints {
  public:
    static constexpr int patterns = 8;
    static constexpr int max_block = 1024;

    /// n: 1 .. 2^20.
    PoissonPoints(std::uint32_t n, std::uint64_t seed);
    /// Points of samples first .. first + count - 1, count 1 .. 16. `permuted`: in random order; else in the
    /// order of the pattern.
    void fill_2d(SetKey key, bool permuted, int first, int count, float* u, float* v) const;
    void fill_1d(SetKey key, bool permuted, int first, int count, float* u) const;

  private:
    /// The patterns for blocks of one size.
    struct Patterns {
        std::array<PoissonPattern, patterns> plane;
        std::array<std::vector<std::uint32_t>, patterns> circle;
    };
    struct Block {
        std::uint32_t index, begin, size;
    };
    [[nodiscard]] Block block_of(std::uint32_t sample) const;
    [[nodiscard]] const Patterns& patterns_of(const Block& b) const;

    std::uint32_t n_, blocks_;
    std::array<Patterns, 2> sizes_;  ///< for blocks of floor(n / blocks) points, and of one more
};

}  // namespace postlens
