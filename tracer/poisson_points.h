// Poisson-disc points on the torus: random points that keep a distance from each other [cook1986].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/sample_hash.h"

namespace postlens {

/// A pattern of points in [0, 1)^2, as fractions of 2^32: adding a shift wraps around by itself.
struct PoissonPattern {
    std::vector<std::uint32_t> u, v;
};

/// The distance of neighbours in the densest arrangement of n points on the plane, one per area 1/n: sqrt(2 /
/// (sqrt(3) n)).
[[nodiscard]] double densest_distance(int n);

/// Exactly n points, 1 .. 1024, of which no two are nearer than `poisson_distance_share` *
/// densest_distance(n) on the torus (a single point: unless to itself). Points are thrown until n have found
/// room; a pattern that jams before is begun anew.
[[nodiscard]] PoissonPattern poisson_pattern(int n, std::uint64_t seed);
/// Points thrown at random jam at 0.547 of the area in discs, which is a share of 0.777; at 0.7 a dart in a
/// hundred still finds room for the last point.
inline constexpr double poisson_distance_share = 0.7;

/// n points on the circle [0, 1), none nearer than poisson_distance_share / n: uniform points on what length
/// the distances leave over, which is exactly what darts that miss no room would give.
[[nodiscard]] std::vector<std::uint32_t> poisson_circle(int n, std::uint64_t seed);

/// Points of a pixel: a pattern out of `patterns`, moved by a random shift around the torus, in random order.
/// More than 1024 samples are independent patterns of at most 1024, all of nearly the same number of points.
class PoissonPoints {
  public:
    static constexpr int patterns = 8;
    static constexpr int max_block = 1024;

    /// n: 1 .. 2^20.
    PoissonPoints(std::uint32_t n, std::uint64_t seed);
    /// Points of samples first .. first + count - 1, count 1 .. 16. `permuted`: in random order, else in the
    /// pattern's.
    void fill_2d(SetKey key, bool permuted, int first, int count, float* u, float* v) const;
    void fill_1d(SetKey key, bool permuted, int first, int count, float* u) const;

  private:
    /// All blocks with the same number of points.
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
    std::array<Patterns, 2> sizes_;  ///< of blocks of floor(n / blocks) points and of one more
};

}  // namespace postlens
