// Point sets for distributed rays: the positions of each ray in the pixel, on the lens and in the shutter
// interval.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>

#include "core/sample_hash.h"
#include "core/sobol.h"
#include "tracer/sampling/poisson_points.h"
#include "tracer/sampling/strata.h"

namespace postlens {

/// Distribution of the points of a pixel. The points of different sets are paired at random, except in
/// `random`, whose points are independent, and in the eye-ray sets of `sobol`, which are jointly distributed.
enum class SamplerKind {
    grid,      ///< the centres of spp cells of equal area
    jittered,  ///< a random point in each of these cells [cook1984]
    random,    ///< independent points
    poisson,   ///< points with a minimum distance from each other [cook1986]
    sobol,     ///< Owen-scrambled Sobol points [owen1995, burley2020]
};

/// Identifies an independent point set. The first three sets hold the dimensions of an eye ray, which are
/// jointly well distributed; `sample_set` makes the other sets.
struct SampleSet {
    std::uint32_t id;
};
inline constexpr SampleSet pixel_set{0}, lens_set{1}, time_set{2};

/// The point set for a purpose (an area light, a glossy bounce ...) and two further numbers, such as the path
/// and the index of the light. It is never one of the three sets of an eye ray. Distinct arguments give
/// distinct sets, except with a probability of 2^-32.
[[nodiscard]] constexpr SampleSet sample_set(std::uint32_t purpose, std::uint32_t a, std::uint32_t b) {
    const std::uint64_t word = mix64(mix64(static_cast<std::uint64_t>(purpose) << 32 | a) ^ b);
    const std::uint32_t id = high_word(word);
    return {id > time_set.id ? id : id + time_set.id + 1};
}

/// Numbers in [0, 1), multiples of 2^-24, as a pure function of (kind, spp, seed, pixel, set, index). All
/// calls give the same bits, on every instruction set and in every order. The one-dimensional and the
/// two-dimensional points of a set are independent. All samples of a pixel must be used: a subset of them
/// need not be well distributed.
class Sampler {
  public:
    static constexpr int max_spp = 1 << 20;

    /// spp: samples per pixel, 1 .. max_spp. Fails with wrong_arguments outside.
    /// `poisson` makes its patterns here, which takes up to a few tenths of a second.
    Sampler(SamplerKind kind, int spp, std::uint64_t seed);

    [[nodiscard]] SamplerKind kind() const { return kind_; }
    [[nodiscard]] int spp() const { return spp_; }

    /// Writes samples [first, first + count) of a pixel, count 1 .. 16, first + count <= spp. `pixel`: any
    /// 32-bit number. Fastest for count = 16 and `first` a multiple of 16.
    void fill_2d(std::uint32_t pixel, SampleSet set, int first, int count, float* u, float* v) const;
    void fill_1d(std::uint32_t pixel, SampleSet set, int first, int count, float* u) const;

    struct EyeSamples {
        alignas(64) float pixel_u[sample_lanes], pixel_v[sample_lanes], lens_u[sample_lanes],
            lens_v[sample_lanes], time_u[sample_lanes];
    };
    /// Writes the points of pixel_set and lens_set in 2-D and of time_set in 1-D. Entries from `count` on are
    /// arbitrary.
    void fill_eye(std::uint32_t pixel, int first, int count, EyeSamples& out) const;

    [[nodiscard]] glm::vec2 point_2d(std::uint32_t pixel, SampleSet set, int index) const;
    [[nodiscard]] float point_1d(std::uint32_t pixel, SampleSet set, int index) const;

  private:
    /// Writes 16 lanes or 1 lane. All lanes are written, even beyond the last sample.
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
