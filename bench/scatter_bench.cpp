// Scatter at 1920x1080, one sample per corner, on 2 threads, against the time to read the samples and write the
// picture once. Each benchmark names its ratio to that time (`per_stream`), measured in the same process.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <random>

#include "core/threads.h"
#include "focus/scatter.h"

namespace {

using namespace postlens;

constexpr int width = 1920, height = 1080;
const int threads = std::getenv("T") ? 1 : 2;

/// Aperture and gain such that a sample at infinity has a CoC of 1 px m * 1/s; depth is then 1/radius.
constexpr FocusGeometry geometry{
    .aperture_radius_m = 1e-3, .inverse_focus_per_m = 0, .gain_px = 1000, .zoom = 1};

template <typename RadiusAt>
RecordBand noise_records(const RadiusAt& radius_at) {
    RecordBand band{.x_begin = 0, .x_end = width + 1, .y_begin = 0, .y_end = height + 1, .offsets = {}, .records = {}};
    band.offsets.resize(static_cast<std::size_t>(band.width()) * static_cast<std::size_t>(band.height()) + 1);
    std::iota(band.offsets.begin(), band.offsets.end(), 0U);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int y = 0; y <= height; ++y) {
        for (int x = 0; x <= width; ++x) {
            Record r;
            r.x = static_cast<float>(x);
            r.y = static_cast<float>(y);
            r.z = 1 / static_cast<float>(radius_at(x, y));
            r.r = uniform(random);
            r.g = uniform(random);
            r.b = uniform(random);
            band.records.push_back(r);
        }
    }
    return band;
}

std::unique_ptr<SplatTables> tables_of(const RecordBand& band) {
    const RasterWindow source{band.x_begin, band.x_end, band.y_begin, band.y_end};
    auto tables = std::make_unique<SplatTables>(source, RasterWindow{0, width, 0, height}, geometry,
                                                DepthLevels(geometry, {}, DepthSpacing::inverse, std::nullopt),
                                                DepthModel::ray_differentials);
    tables->add_rows(band, band.y_begin, band.y_end);
    tables->finish();
    return tables;
}

/// Position, depth and colour alone: the least that a blur must read.
struct PlainSample {
    float x, y, z, r, g, b;
};

double stream_seconds() {
    static const double best = [] {
        const ThreadLimit limit(threads);
        std::vector<PlainSample> samples(static_cast<std::size_t>(width) * height, PlainSample{1, 1, 1, 1, 1, 1});
        Image image(width, height);
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 20; ++i) {
            const auto start = std::chrono::steady_clock::now();
            parallel_for(height, [&](std::size_t y) {
                const PlainSample* s = samples.data() + y * width;
                float* out = image.pixel(0, static_cast<int>(y));
                for (int x = 0; x < width; ++x, ++s, out += 3) {
                    const float scale = s->x + s->y + s->z;
                    out[0] = scale * s->r;
                    out[1] = scale * s->g;
                    out[2] = scale * s->b;
                }
            }, 16);
            benchmark::DoNotOptimize(image.rgb.data());
            least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
        return least;
    }();
    return best;
}

void run_scatter(benchmark::State& state, const RecordBand& band) {
    const ThreadLimit limit(threads);
    const auto tables = tables_of(band);
    Image image(width, height);
    double least = std::numeric_limits<double>::infinity();
    for (auto _ : state) {
        const auto start = std::chrono::steady_clock::now();
        scatter(*tables, image);
        benchmark::DoNotOptimize(image.rgb.data());
        least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    state.counters["least_ms"] = 1e3 * least;
    state.counters["per_stream"] = least / stream_seconds();
}

void stream(benchmark::State& state) {
    for (auto _ : state) state.SetIterationTime(stream_seconds());
    state.counters["least_ms"] = 1e3 * stream_seconds();
}
BENCHMARK(stream)->UseManualTime()->Iterations(1);

/// Range: radius of the CoC, px.
void one_radius(benchmark::State& state) {
    const double radius_px = static_cast<double>(state.range(0));
    run_scatter(state, noise_records([&](int, int) { return radius_px; }));
}
BENCHMARK(one_radius)->Arg(1)->Arg(4)->Arg(8)->Arg(16)->Arg(64)->Arg(256)->Unit(benchmark::kMillisecond)->Iterations(6);

/// A wall seen at an angle: a radius of 0 to 32 px from left to right.
void slanted_wall(benchmark::State& state) {
    run_scatter(state, noise_records([](int x, int) { return 1e-3 + 32.0 * x / width; }));
}
BENCHMARK(slanted_wall)->Unit(benchmark::kMillisecond)->Iterations(4);

/// Depth without order, as in foliage: radii of 1 to 32 px that change every so many samples of a row (range).
void random_depth(benchmark::State& state) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> radius(1, 32);
    double radius_px = 1;
    run_scatter(state, noise_records([&](int x, int) {
                    if (x % state.range(0) == 0) radius_px = radius(random);
                    return radius_px;
                }));
}
BENCHMARK(random_depth)->Arg(1)->Arg(4)->Arg(8)->Arg(16)->Unit(benchmark::kMillisecond)->Iterations(2);

/// From records to splats.
void take_in(benchmark::State& state) {
    const ThreadLimit limit(threads);
    const RecordBand band = noise_records([](int, int) { return 16.0; });
    for (auto _ : state) benchmark::DoNotOptimize(tables_of(band)->levels_used());
}
BENCHMARK(take_in)->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
