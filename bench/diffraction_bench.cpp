// Diffraction impulse responses of the circular aperture for 64 depths, as `focus` computes them,
// with CoC radii up to 64 px. Lens 50 mm f/1.8, pixels of 18.75 um (about 60 units of the Lommel
// coordinate v), two threads.
#include <benchmark/benchmark.h>
#include <vector>

#include "core/threads.h"
#include "lens/lommel/lommel_rows.h"
#include "lens/wave/diffraction_response.h"

namespace {

using namespace postlens;

constexpr int depths = 64;

FocusGeometry geometry() {
    return focus_geometry({.focal_length_mm = 50, .f_number = 1.8}, 2, Framing::breathing,
                          {.distance_mm = 50, .pixel_pitch_mm = 0.01875});
}

void depths_at_once(benchmark::State& state, const DiffractionSettings& settings, bool all_widest) {
    const ThreadLimit limit(2);
    std::vector<double> cocs;
    for (int i = 0; i < depths; ++i) cocs.push_back(all_widest ? 128 : 128.0 * i / (depths - 1));
    for (auto _ : state) {
        benchmark::DoNotOptimize(diffraction_responses(geometry(), cocs, settings));
    }
    state.SetItemsProcessed(state.iterations() * depths);
}

const double green_nm = 550;

void one_wavelength(benchmark::State& state) {
    depths_at_once(state, {.spectrum = equal_lines({&green_nm, 1})}, state.range(0) != 0);
}
void channel_bands_at_corners(benchmark::State& state) {
    depths_at_once(state, {}, state.range(0) != 0);
}
void channel_bands_anywhere(benchmark::State& state) {
    depths_at_once(state, {.centre_x = 0.3, .centre_y = 0.7}, state.range(0) != 0);
}

void one_row(benchmark::State& state) {
    const auto u = static_cast<double>(state.range(0));
    const BesselGrid grid(0.5, static_cast<std::size_t>(2 * (u + 100)));
    std::vector<double> intensity(grid.j0.size());
    for (auto _ : state) {
        lommel_row(u, grid, intensity);
        benchmark::DoNotOptimize(intensity.data());
    }
}

}  // namespace

// Argument 0: CoC radii from 0 to 64 px; 1: all radii 64 px.
BENCHMARK(one_wavelength)
    ->Arg(0)
    ->Arg(1)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(channel_bands_at_corners)
    ->Arg(0)
    ->Arg(1)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(channel_bands_anywhere)
    ->Arg(0)
    ->Arg(1)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(one_row)->Arg(500)->Arg(1000)->Arg(2000)->Arg(4211)->Unit(benchmark::kMillisecond);
