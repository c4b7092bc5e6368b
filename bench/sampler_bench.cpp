// Cost of the random numbers of eye rays, for every kind of point set, in batches and one at a time.
//   sampler_bench --benchmark_enable_random_interleaving=true --benchmark_repetitions=5
#include <benchmark/benchmark.h>

#include "tracer/sampling/sampler.h"

namespace postlens {
namespace {

void report(benchmark::State& state, double samples) {
    // The counter is in seconds; the console prints it in ns.
    state.counters["per_sample"] = benchmark::Counter(
        samples, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// All five random numbers of every eye ray of a row of pixels, for 16 rays at a time.
void eye(benchmark::State& state, SamplerKind kind) {
    const int spp = static_cast<int>(state.range(0)), pixels = 4096 / spp;
    const Sampler sampler(kind, spp, 1);
    Sampler::EyeSamples out{};
    for (auto _ : state) {
        for (int p = 0; p < pixels; ++p) {
            for (int first = 0; first < spp; first += sample_lanes) {
                sampler.fill_eye(static_cast<std::uint32_t>(p), first, std::min(sample_lanes, spp - first),
                                 out);
                benchmark::DoNotOptimize(out);
            }
        }
    }
    report(state, static_cast<double>(pixels) * spp);
}

// Points of a further 2D set, e.g. on an area light, for one sample at a time.
void one_point(benchmark::State& state, SamplerKind kind) {
    const int spp = static_cast<int>(state.range(0));
    const Sampler sampler(kind, spp, 1);
    const SampleSet set = sample_set(1, 2, 3);
    for (auto _ : state) {
        for (int i = 0; i < spp; ++i) benchmark::DoNotOptimize(sampler.point_2d(7, set, i));
    }
    report(state, spp);
}

// Points of a further 2D set, e.g. on an area light, for 16 samples at a time.
void sixteen_points(benchmark::State& state, SamplerKind kind) {
    const int spp = static_cast<int>(state.range(0));
    const Sampler sampler(kind, spp, 1);
    const SampleSet set = sample_set(1, 2, 3);
    alignas(64) float u[sample_lanes], v[sample_lanes];
    for (auto _ : state) {
        for (int first = 0; first < spp; first += sample_lanes) {
            sampler.fill_2d(7, set, first, sample_lanes, u, v);
            benchmark::DoNotOptimize(u);
            benchmark::DoNotOptimize(v);
        }
    }
    report(state, spp);
}

void construct(benchmark::State& state, SamplerKind kind) {
    for (auto _ : state) {
        Sampler sampler(kind, static_cast<int>(state.range(0)), 1);
        benchmark::DoNotOptimize(sampler);
    }
}

// NOLINTBEGIN(modernize-use-nodiscard,cppcoreguidelines-init-variables): code from the macros
#define POSTLENS_SAMPLER_BENCH(kind)                                             \
    BENCHMARK_CAPTURE(eye, kind, SamplerKind::kind)->Arg(4)->Arg(64)->Arg(1024); \
    BENCHMARK_CAPTURE(one_point, kind, SamplerKind::kind)->Arg(64);              \
    BENCHMARK_CAPTURE(sixteen_points, kind, SamplerKind::kind)->Arg(64);         \
    BENCHMARK_CAPTURE(construct, kind, SamplerKind::kind)->Arg(1024)->Unit(benchmark::kMillisecond)
POSTLENS_SAMPLER_BENCH(grid);
POSTLENS_SAMPLER_BENCH(jittered);
POSTLENS_SAMPLER_BENCH(random);
POSTLENS_SAMPLER_BENCH(poisson);
POSTLENS_SAMPLER_BENCH(sobol);
// NOLINTEND(modernize-use-nodiscard,cppcoreguidelines-init-variables)

}  // namespace
}  // namespace postlens
