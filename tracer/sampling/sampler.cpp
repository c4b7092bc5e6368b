#include "tracer/sampling/sampler.h"

#include <algorithm>
#include <cassert>

#include "core/error.h"
#include "core/multiversion.h"

namespace postlens {
namespace {

int checked_spp(int spp) {
    if (spp < 1 || spp > Sampler::max_spp)
        fail(ExitCode::wrong_arguments, "--spp: out of range (got {}; expected 1 to {})", spp,
             Sampler::max_spp);
    return spp;
}

[[gnu::always_inline]] inline SetKey set_key(std::uint64_t key, std::uint32_t pixel, SampleSet set) {
    return {mix64(key ^ (static_cast<std::uint64_t>(pixel) << 32 | set.id))};
}

template <int lanes>
[[gnu::always_inline]] inline void random_points(std::uint64_t key, int first, float* u) {
    for (int i = 0; i < lanes; ++i)
        u[i] = unit_float(random_word(key, static_cast<std::uint32_t>(first + i)));
}
POSTLENS_MULTIVERSION void random_points_16(std::uint64_t key, int first, float* u) {
    random_points<sample_lanes>(key, first, u);
}
void random_lanes(std::uint64_t key, int first, int lanes, float* u) {
    lanes == 1 ? random_points<1>(key, first, u) : random_points_16(key, first, u);
}

}  // namespace

Sampler::Sampler(SamplerKind kind, int spp, std::uint64_t seed)
    : kind_(kind),
      spp_(checked_spp(spp)),
      key_1d_(SetKey{mix64(seed)}.stream(1)),
      key_2d_(SetKey{mix64(seed)}.stream(2)),
      strata_(static_cast<std::uint32_t>(spp_)),
      padding_(static_cast<std::uint32_t>(spp_)) {
    if (kind == SamplerKind::poisson)
        poisson_.emplace(static_cast<std::uint32_t>(spp_), SetKey{mix64(seed)}.stream(3));
}

void Sampler::lanes_2d(std::uint32_t pixel, SampleSet set, int first, int lanes, float* u, float* v) const {
    const SetKey key = set_key(key_2d_, pixel, set);
    const bool permuted = set.id != pixel_set.id;
    switch (kind_) {
        case SamplerKind::grid:
            return strata_.fill_2d(key, CellPoint::centre, permuted, first, lanes, u, v);
        case SamplerKind::jittered:
            return strata_.fill_2d(key, CellPoint::random, permuted, first, lanes, u, v);
        case SamplerKind::random:
            random_lanes(key.stream(0), first, lanes, u);
            return random_lanes(key.stream(1), first, lanes, v);
        case SamplerKind::poisson:
            return poisson_->fill_2d(key, permuted, first, std::min(lanes, spp_ - first), u, v);
        case SamplerKind::sobol:
            if (set.id == pixel_set.id || set.id == lens_set.id) {
                const int dimension = set.id == pixel_set.id ? 0 : 2;
                sobol_joint(dimension, low_word(key.value), first, lanes, u);
                return sobol_joint(dimension + 1, high_word(key.value), first, lanes, v);
            }
            return padding_.fill_2d(key, first, lanes, u, v);
    }
}

void Sampler::lanes_1d(std::uint32_t pixel, SampleSet set, int first, int lanes, float* u) const {
    const SetKey key = set_key(key_1d_, pixel, set);
    switch (kind_) {
        case SamplerKind::grid:
            return strata_.fill_1d(key, CellPoint::centre, true, first, lanes, u);
        case SamplerKind::jittered:
            return strata_.fill_1d(key, CellPoint::random, true, first, lanes, u);
        case SamplerKind::random:
            return random_lanes(key.stream(0), first, lanes, u);
        case SamplerKind::poisson:
            return poisson_->fill_1d(key, true, first, std::min(lanes, spp_ - first), u);
        case SamplerKind::sobol:
            if (set.id == time_set.id) return sobol_joint(4, low_word(key.value), first, lanes, u);
            return padding_.fill_1d(key, first, lanes, u);
    }
}

void Sampler::fill_2d(std::uint32_t pixel, SampleSet set, int first, int count, float* u, float* v) const {
    assert(first >= 0 && count >= 1 && count <= sample_lanes && first + count <= spp_);
    if (count == sample_lanes || count == 1) return lanes_2d(pixel, set, first, count, u, v);
    alignas(64) float all_u[sample_lanes], all_v[sample_lanes];
    lanes_2d(pixel, set, first, sample_lanes, all_u, all_v);
    std::copy_n(all_u, count, u);
    std::copy_n(all_v, count, v);
}

void Sampler::fill_1d(std::uint32_t pixel, SampleSet set, int first, int count, float* u) const {
    assert(first >= 0 && count >= 1 && count <= sample_lanes && first + count <= spp_);
    if (count == sample_lanes || count == 1) return lanes_1d(pixel, set, first, count, u);
    alignas(64) float all_u[sample_lanes];
    lanes_1d(pixel, set, first, sample_lanes, all_u);
    std::copy_n(all_u, count, u);
}

void Sampler::fill_eye(std::uint32_t pixel, int first, [[maybe_unused]] int count, EyeSamples& out) const {
    assert(first >= 0 && count >= 1 && count <= sample_lanes && first + count <= spp_);
    if (kind_ == SamplerKind::sobol) {
        const std::uint64_t in_pixel = set_key(key_2d_, pixel, pixel_set).value,
                            on_lens = set_key(key_2d_, pixel, lens_set).value,
                            in_time = set_key(key_1d_, pixel, time_set).value;
        return sobol_joint_16({low_word(in_pixel), high_word(in_pixel), low_word(on_lens), high_word(on_lens),
                               low_word(in_time)},
                              first, {out.pixel_u, out.pixel_v, out.lens_u, out.lens_v, out.time_u});
    }
    lanes_2d(pixel, pixel_set, first, sample_lanes, out.pixel_u, out.pixel_v);
    lanes_2d(pixel, lens_set, first, sample_lanes, out.lens_u, out.lens_v);
    lanes_1d(pixel, time_set, first, sample_lanes, out.time_u);
}

glm::vec2 Sampler::point_2d(std::uint32_t pixel, SampleSet set, int index) const {
    glm::vec2 p;
    fill_2d(pixel, set, index, 1, &p.x, &p.y);
    return p;
}

float Sampler::point_1d(std::uint32_t pixel, SampleSet set, int index) const {
    float u = 0;
    fill_1d(pixel, set, index, 1, &u);
    return u;
}

}  // namespace postlens
