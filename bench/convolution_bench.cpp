// Convolution of moving objects with their paths, directly and by FFT, with the predicted seconds of each.
//   convolution_bench --benchmark_enable_random_interleaving=true --benchmark_repetitions=5
// `three_objects` uses two threads. The others use one thread, for which the predictions are made.
#include <benchmark/benchmark.h>
#include <cmath>
#include <random>

#include "core/threads.h"
#include "motionblur/convolution/convolution.h"

namespace postlens {
namespace {

/// A disc of random values with a diameter of `size` cells.
Planes disc(int size, std::size_t planes) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(0, 1);
    Planes out{0, 0, size, size,
               std::vector(planes, std::vector<float>(static_cast<std::size_t>(size) *
                                                      static_cast<std::size_t>(size)))};
    for (auto& plane : out.planes) {
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const double dx = (x + 0.5) / size - 0.5, dy = (y + 0.5) / size - 0.5;
                if (dx * dx + dy * dy < 0.25) plane[static_cast<std::size_t>(y * size + x)] = uniform(random);
            }
        }
    }
    return out;
}

PathRaster straight(double way_px, double degrees, const ShutterCurve& curve, int cells_per_px) {
    const double angle = degrees * std::acos(-1) / 180;
    const PathPoint points[] = {{0, {0, 0}}, {1, {way_px * std::cos(angle), way_px * std::sin(angle)}}};
    return draw_path(points, glm::dvec2(0), 0, 1, curve, cells_per_px);
}

void report(benchmark::State& state, const Planes& i1, const PathRaster& i2, ConvolutionMethod method) {
    const ConvolutionCosts costs = predict_costs(i1, i2);
    state.counters["predicted_ms"] =
        1e3 * (method == ConvolutionMethod::direct ? costs.direct_s : costs.fft_s);
}

/// Arguments: diameter of the object in cells, length of the path in px, its direction in degrees, shutter
/// curve (0 box, 1 triangle).
void one_object(benchmark::State& state, ConvolutionMethod method) {
    const ThreadLimit limit(1);
    const Planes i1 = disc(static_cast<int>(state.range(0)), 4);
    const PathRaster i2 = straight(static_cast<double>(state.range(1)), static_cast<double>(state.range(2)),
                                   state.range(3) == 0 ? ShutterCurve::box() : ShutterCurve::triangle(), 1);
    for (auto _ : state) benchmark::DoNotOptimize(convolve(i1, i2, method));
    report(state, i1, i2, method);
}

/// Three objects of 300 px on paths of 120 px in different directions, with two cells per pixel
/// and four planes each.
void three_objects(benchmark::State& state, ConvolutionMethod method) {
    const ThreadLimit limit(2);
    const Planes i1 = disc(600, 4);
    const ShutterCurve curve = state.range(0) == 0 ? ShutterCurve::box() : ShutterCurve::triangle();
    for (auto _ : state) {
        for (const double degrees : {10.0, 45.0, 80.0})
            benchmark::DoNotOptimize(convolve(i1, straight(120, degrees, curve, 2), method));
    }
}

/// Draws a path raster of 120 px with four cells per pixel.
void draw(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(straight(120, 33, ShutterCurve::triangle(), 4));
}

// NOLINTBEGIN(modernize-use-nodiscard,cppcoreguidelines-init-variables): code from the macros
#define POSTLENS_CONVOLUTION_BENCH(method)                                   \
    BENCHMARK_CAPTURE(one_object, method, ConvolutionMethod::method)         \
        ->ArgsProduct({{64, 300, 1000}, {8, 60, 240}, {0, 30, 45, 90}, {0}}) \
        ->Args({300, 60, 0, 1})                                              \
        ->Args({1000, 240, 45, 1})                                           \
        ->Unit(benchmark::kMillisecond);                                     \
    BENCHMARK_CAPTURE(three_objects, method, ConvolutionMethod::method)      \
        ->Arg(0)                                                             \
        ->Arg(1)                                                             \
        ->Unit(benchmark::kMillisecond)                                      \
        ->UseRealTime()
POSTLENS_CONVOLUTION_BENCH(direct);
POSTLENS_CONVOLUTION_BENCH(fft);
POSTLENS_CONVOLUTION_BENCH(automatic);
// NOLINTEND(modernize-use-nodiscard,cppcoreguidelines-init-variables)
BENCHMARK(draw)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace postlens
