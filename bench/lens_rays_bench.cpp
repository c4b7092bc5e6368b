// Real lens rays: rays per second through the eleven surfaces of a double Gauss,
// impulse responses and kernels.
#include <benchmark/benchmark.h>

#include "lens/prescription/read_prescription.h"
#include "lens/traced/fan_table.h"
#include "lens/traced/traced_lens.h"

namespace postlens {
namespace {

const TracedLens& double_gauss() {
    static const TracedLens lens(read_prescription(POSTLENS_LENS_SAMPLES "/double_gauss.toml"),
                                 {.focus_distance_m = 2});
    return lens;
}

void from_scene(benchmark::State& state) {
    const TracedLens& lens = double_gauss();
    double y = 0;
    for (auto _ : state) {
        y = y < 20 ? y + 0.37 : -20;
        LensRay ray = lens.object_ray(3, {0.05, 0.1}, {0.4 * y, 0.5 * y});
        benchmark::DoNotOptimize(lens.stack().forward(ray));
        benchmark::DoNotOptimize(ray);
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(from_scene);

void from_film(benchmark::State& state) {
    const TracedLens& lens = double_gauss();
    double u = 0;
    SceneRay ray;
    for (auto _ : state) {
        u = u < 0.99 ? u + 0.0137 : 0;
        benchmark::DoNotOptimize(lens.scene_ray({5, 10 * u}, {u, 0.5}, ray));
        benchmark::DoNotOptimize(ray);
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(from_film);

void impulse(benchmark::State& state) {
    const TracedLens& lens = double_gauss();
    const int nodes = static_cast<int>(state.range(0));
    PupilMesh mesh;
    for (auto _ : state) benchmark::DoNotOptimize(lens.impulse(3, {0, 0.1}, nodes, mesh));
    state.SetItemsProcessed(state.iterations() * nodes * nodes);
}
BENCHMARK(impulse)->Arg(33)->Arg(129)->Unit(benchmark::kMillisecond);

const LensView& view() {
    static const LensView view(read_prescription(POSTLENS_LENS_SAMPLES "/double_gauss.toml"),
                               {.focus_distance_m = 2,
                                .film = {.distance_mm = 100, .pixel_pitch_mm = 0.0375},
                                .half_diagonal_px = 550});
    return view;
}

// The table that `focus` prepares for one setting of the lens.
void fan_table(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(FanTable(view(), 1, 0.22));
}
BENCHMARK(fan_table)->Unit(benchmark::kMillisecond)->UseRealTime();

// One impulse response. Argument: its approximate radius, px.
void fan_kernel(benchmark::State& state) {
    static const FanTable table(view(), 1, 0.22);
    const auto radius_px = static_cast<double>(state.range(0));
    const double gain_px = radius_px / (view().geometry().aperture_radius_m * 0.5);
    const int window = 4 * static_cast<int>(radius_px);
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            fan_response(table.fan(0, 0.11), {.gain_px = gain_px}, {-window, window, -window, window}));
    }
}
BENCHMARK(fan_kernel)->Arg(2)->Arg(8)->Arg(32)->Arg(64)->Unit(benchmark::kMicrosecond);

void set_up(benchmark::State& state) {
    const Prescription lens = read_prescription(POSTLENS_LENS_SAMPLES "/double_gauss.toml");
    for (auto _ : state) benchmark::DoNotOptimize(TracedLens(lens, {.focus_distance_m = 2}));
}
BENCHMARK(set_up)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace postlens
