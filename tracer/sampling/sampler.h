// Random numbers for eye rays: their positions in the pixel, on the lens and in the shutter interval.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>

#include "core/sample_hash.h"
#include "core/sobol.h"
#include "tracer/sampling/poisson_points.h"
#include "tracer/sampling/strata.h"

namespace postlens {

/// How the samples of a pixel are distributed. A pixel has spp samples, and each of them has a raster
/// position, a lens point and an instant. The raster positions are distributed by this rule, and so are the
/// lens points and the instants. Which of them belong to the same sample is then chosen at random. Only
/// `sobol` also distributes their combinations evenly, so that, for example, each part of the lens gets
/// instants from the whole exposure.
enum class SamplerKind {
    grid,      ///< the centres of spp cells of equal area
    jittered,  ///< a random point in each of these cells [cook1984]
    random,    ///< independent points
    poisson,   ///< points with a minimum distance from each other [cook1986]
    sobol,     ///< Owen-scrambled Sobol points [owen1995, burley2020]
};

/// Identifies a set of random points that is independent of all other sets. Three sets are for eye rays:
/// their positions in the pixel, their lens points and their instants. The function `sample_set` makes
/// further ones, for example for the random directions of reflected rays.
struct SampleSet {
    std::uint32_t id;
};
inline constexpr SampleSet pixel_set{0}, lens_set{1}, time_set{2};

/// Returns a set of random points for one purpose, such as area lights. If a purpose needs several sets, `a`
/// and `b` distinguish them. Two different sets have the same points with a probability of only 2^-32.
[[nodiscard]] constexpr SampleSet sample_set(std::uint32_t purpose, std::uint32_t a, std::uint32_t b) {
    const std::uint64_t word = mix64(mix64(static_cast<std::uint64_t>(purpose) << 32 | a) ^ b);
    const std::uint32_t id = high_word(word);
    return {id > time_set.id ? id : id + time_set.id + 1};
}

/// Makes random numbers and points for the samples of a pixel. The numbers are multiples of 2^-24 in [0, 1),
/// and are equal on all processors. All samples of a pixel should be used, because a subset of them may not
/// be well distributed. The 1D and 2D points of a SampleSet are independent of each other.
class Sampler {
  public:
    static constexpr int max_spp = 1 << 20;

    /// `spp` is the number of samples per pixel. Throws Error(wrong_arguments) if it is not in 1 .. max_spp.
    /// For the kind `poisson`, the construction takes up to a few tenths of a second, because patterns of
    /// points are computed.
    Sampler(SamplerKind kind, int spp, std::uint64_t seed);

    [[nodiscard]] SamplerKind kind() const { return kind_; }
    [[nodiscard]] int spp() const { return spp_; }

    /// Writes random points with coordinates u and v in [0, 1), one for each of the samples [first, first +
    /// count) of a pixel. `set` selects one of several independent sets of points.
    /// `count` is 1 .. 16, and first + count is at most the number of samples per pixel. Fastest if `count`
    /// is 16 and `first` is a multiple of 16.
    void fill_2d(std::uint32_t pixel, SampleSet set, int first, int count, float* u, float* v) const;
    void fill_1d(std::uint32_t pixel, SampleSet set, int first, int count, float* u) const;

    struct EyeSamples {
        alignas(64) float pixel_u[sample_lanes], pixel_v[sample_lanes], lens_u[sample_lanes],
            lens_v[sample_lanes], time_u[sample_lanes];
    };
    /// Writes the sample points of `count` eye rays of a pixel, beginning with sample number `first`. Each
    /// eye ray gets a position in the pixel, a lens point and a time. The entries of `out` from index `count`
    /// on are undefined.
    void fill_eye(std::uint32_t pixel, int first, int count, EyeSamples& out) const;

    [[nodiscard]] glm::vec2 point_2d(std::uint32_t pixel, SampleSet set, int index) const;
    [[nodiscard]] float point_1d(std::uint32_t pixel, SampleSet set, int index) const;

  private:
    /// These functions write a random point (2d) or a random number (1d) for each of the samples `first` to
    /// `first` + lanes - 1 of a pixel, where `lanes` is 1 or 16. `set` selects one of several independent
    /// sets of points. A pixel has only the samples 0 to spp - 1; the points of all others are undefined.
    void lanes_2d(std::uint32_t pixel, SampleSet set, int first, int lanes, float* u, float* v) const;
    void lanes_1d(std::uint32_t pixel, SampleSet set, int first, int lanes, float* u) const;

    SamplerKind kind_;
    int spp_;
    std::uint64_t key_1d_, key_2d_;
    Strata strata_;
    SobolPadding padding_;
    std::optional<PoissonPoints> poisson_;
};

}  // namespace postlens
