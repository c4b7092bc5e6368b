// Scatter at 1920x1080 with one sample per pixel corner, on 2 threads, compared to reading the records
// and writing the image once (`stream`). Each benchmark reports the least time of its runs and the
// ratio to `stream` in the same process. The time of scatter excludes `take_in`, which makes the splat
// tables that scatter reads.
#include <algorithm>
#include <benchmark/benchmark.h>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <random>

#include "core/threads.h"
#include "focus/scatter/scatter.h"

namespace {

using namespace postlens;

constexpr int width = 1920, height = 1080;
constexpr int threads = 2;

/// Focus at infinity, chosen so that a sample at depth z' = 1/r m has a CoC of radius r px.
constexpr FocusGeometry geometry{
    .aperture_radius_m = 1e-3, .inverse_focus_per_m = 0, .gain_px = 1000, .zoom = 1};

template <typename RadiusAt>
RecordBand noise_records(const RadiusAt& radius_at) {
    RecordBand band{
        .x_begin = 0, .x_end = width + 1, .y_begin = 0, .y_end = height + 1, .offsets = {}, .records = {}};
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
    auto tables = std::make_unique<SplatTables>(
        source, RasterWindow{0, width, 0, height}, geometry,
        DepthLevels(geometry, {}, DepthSpacing::inverse, std::nullopt), DepthModel::ray_differentials);
    tables->add_rows(band, band.y_begin, band.y_end);
    tables->finish();
    return tables;
}

/// Least time of `runs` calls of `run`, s.
template <typename Run>
double least_seconds(int runs, const Run& run) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < runs; ++i) {
        const auto start = std::chrono::steady_clock::now();
        run();
        least =
            std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return least;
}

/// Least time, s, to read position, depth and colour of every record and write an image without blur.
double stream_seconds() {
    static const double best = [] {
        const ThreadLimit limit(threads);
        const RecordBand band = noise_records([](int, int) { return 1.0; });
        Image image(width, height);
        return least_seconds(20, [&] {
            parallel_for(
                height,
                [&](std::size_t y) {
                    const Record* r = band.records.data() + band.pixel(0, static_cast<int>(y));
                    float* out = image.pixel(0, static_cast<int>(y));
                    for (int x = 0; x < width; ++x, ++r, out += 3) {
                        const float scale = r->x + r->y + r->z;
                        out[0] = scale * r->r;
                        out[1] = scale * r->g;
                        out[2] = scale * r->b;
                    }
                },
                16);
            benchmark::DoNotOptimize(image.rgb.data());
        });
    }();
    return best;
}

void report(benchmark::State& state, double seconds) {
    state.counters["least_ms"] = 1e3 * seconds;
    state.counters["per_stream"] = seconds / stream_seconds();
}

void run_scatter(benchmark::State& state, const RecordBand& band) {
    const ThreadLimit limit(threads);
    const auto tables = tables_of(band);
    Image image(width, height);
    double least = std::numeric_limits<double>::infinity();
    for (auto _ : state) {
        least = std::min(least, least_seconds(1, [&] { scatter(*tables, image); }));
        benchmark::DoNotOptimize(image.rgb.data());
    }
    report(state, least);
}

void stream(benchmark::State& state) {
    for (auto _ : state) state.SetIterationTime(stream_seconds());
    report(state, stream_seconds());
}
BENCHMARK(stream)->UseManualTime()->Iterations(1)->Unit(benchmark::kMillisecond);

/// All samples have the same CoC. Argument: its radius, px.
void one_radius(benchmark::State& state) {
    const auto radius_px = static_cast<double>(state.range(0));
    run_scatter(state, noise_records([&](int, int) { return radius_px; }));
}
BENCHMARK(one_radius)
    ->Arg(1)
    ->Arg(4)
    ->Arg(8)
    ->Arg(16)
    ->Arg(64)
    ->Arg(256)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(10);

/// A wall seen at an angle: the CoC radius grows from 0 to 32 px from left to right.
void slanted_wall(benchmark::State& state) {
    run_scatter(state, noise_records([](int x, int) { return 1e-3 + 32.0 * x / width; }));
}
BENCHMARK(slanted_wall)->Unit(benchmark::kMillisecond)->Iterations(4);

/// Random depths, as in foliage: CoC radii of 1 to 32 px. Argument: number of successive samples of a row
/// with the same radius.
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

/// Adds every pixel of every disc one by one, straight from the definition, on one thread.
/// Argument: CoC radius, px.
void brute_force(benchmark::State& state) {
    const auto radius_px = static_cast<double>(state.range(0));
    const auto tables = tables_of(noise_records([&](int, int) { return radius_px; }));
    for (auto _ : state)
        report(state, least_seconds(1, [&] { benchmark::DoNotOptimize(scatter_reference(*tables)); }));
}
BENCHMARK(brute_force)->Arg(4)->Arg(16)->Unit(benchmark::kMillisecond)->Iterations(1);

/// Makes the splat tables from records in memory.
void take_in(benchmark::State& state) {
    const ThreadLimit limit(threads);
    const RecordBand band = noise_records([](int, int) { return 16.0; });
    double least = std::numeric_limits<double>::infinity();
    for (auto _ : state) {
        least = std::min(least,
                         least_seconds(1, [&] { benchmark::DoNotOptimize(tables_of(band)->levels_used()); }));
    }
    report(state, least);
}
BENCHMARK(take_in)->Unit(benchmark::kMillisecond)->Iterations(5);

}  // namespace
