// Poisson-disc points on the torus: random points with a minimum distance from each other [cook1986].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/sample_hash.h"

namespace postlens {

/// A pattern of points in [0, 1)^2. Coordinates are in units of 2^-32, so that adding a shift wraps around
/// the torus.
struct PoissonPattern {
    std::vector<std::uint32_t> u, v;
};

/// Returns the distance of neighbours in the densest (hexagonal) arrangement of points in the plane, with one
/// point per area 1/n: sqrt(2 / (sqrt(3) n)).
[[nodiscard]] double densest_distance(int n);

/// Returns exactly n points, 1 .. 1024. On the torus, no two are nearer than `poisson_distance_share` *
/// densest_distance(n). Random points are tried until n of them have this distance. If there is no space for
/// a further point before that, the pattern is started again.
[[nodiscard]] PoissonPattern poisson_pattern(int n, std::uint64_t seed);
/// Minimum distance of points, as a fraction of that in the densest arrangement. When random points leave no
/// space for another one, their discs cover 0.547 of the area, which corresponds to a fraction of 0.777. At
/// 0.7, one in a hundred random points still fits as the last point.
inline constexpr double poisson_distance_share = 0.7;

/// Returns n points on the circle [0, 1), no two of which are nearer than poisson_distance_share / n. Uniform
/// points are placed on the length that remains without the minimum distances. This gives the exact
/// distribution of random points with a minimum distance.
[[nodiscard]] std::vector<std::uint32_t> poisson_circle(int n, std::uint64_t seed);

/// The points of a pixel: one of `patterns` patterns, shifted at random on the torus, in random order. More
/// than 1024 samples are divided into independent blocks of almost equal size, with at most 1024 points each.
class PoissonPoints {
  public:
    static constexpr int patterns = 8;
    static constexpr int max_block = 1024;

    /// n: 1 .. 2^20.
    PoissonPoints(std::uint32_t n, std::uint64_t seed);
    /// Writes the points of samples first .. first + count - 1, with count in 1 .. 16. `permuted`: in random
    /// order, otherwise in the order of the pattern.
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
    /// for blocks of floor(n / blocks) points, and for blocks with one point more
    std::array<Patterns, 2> sizes_;
};

}  // namespace postlens
