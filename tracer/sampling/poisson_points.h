// Poisson-disc points on the torus: random points with a minimum distance from each other [cook1986].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/sample_hash.h"

namespace postlens {

/// Points (u, v) on the torus [0, 1)^2, i.e. on a square whose opposite sides are joined. The coordinates are
/// integers in units of 2^-32. So if a shift is added to a coordinate, integer overflow wraps it around the
/// torus.
struct PoissonPattern {
    std::vector<std::uint32_t> u, v;
};

/// Returns the largest possible minimum distance between n points per unit area: sqrt(2 / (sqrt(3) n)).
/// Points on a hexagonal grid have this distance.
[[nodiscard]] double densest_distance(int n);

/// Returns n random points with a minimum distance from each other, where n is 1 to 1024. They lie on the
/// torus [0, 1)^2. densest_distance(n) is the largest minimum distance that n points can have. The returned
/// points are at least `poisson_distance_share` times this distance apart.
[[nodiscard]] PoissonPattern poisson_pattern(int n, std::uint64_t seed);
/// Minimum distance between the points of a pattern, as a fraction of the largest possible one
/// (densest_distance). The points are placed at random, one after another, so that each keeps this distance
/// from all others. The fraction must not be much greater: at 0.777, there would rarely be room left for the
/// last point.
inline constexpr double poisson_distance_share = 0.7;

/// Returns n random points on a circle of circumference 1, as integers in units of 2^-32. Neighbours are at
/// least d = poisson_distance_share / n apart. To achieve this, n uniform points are placed on a circle with
/// the shorter circumference 1 - n d. Then an arc of length d is inserted after each point, which makes the
/// circumference 1.
[[nodiscard]] std::vector<std::uint32_t> poisson_circle(int n, std::uint64_t seed);

/// Poisson-disc points for the samples of a pixel: a precomputed pattern, shifted and in random order.
/// More than 1024 samples are divided into blocks of almost equal size, each with its own pattern.
class PoissonPoints {
  public:
    static constexpr int patterns = 8;
    static constexpr int max_block = 1024;

    /// n: 1 .. 2^20.
    PoissonPoints(std::uint32_t n, std::uint64_t seed);
    /// Writes one point (u, v) for each of the samples [first, first + count) of a pixel, where `count` is 1
    /// to 16. The points come from a Poisson-disc pattern, i.e. they have a minimum distance from each other.
    /// If `permuted` is true, the samples get the pattern's points in random order, otherwise in the
    /// pattern's own order.
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
    /// The patterns of random points. A pixel has n_ samples, which are divided into `blocks_` blocks, and
    /// each block uses one pattern. If n_ is not a multiple of blocks_, some blocks contain floor(n_ /
    /// blocks_) samples and others one more. sizes_[0] holds the patterns for the smaller blocks, and
    /// sizes_[1] those for the larger ones.
    std::array<Patterns, 2> sizes_;
};

}  // namespace postlens
