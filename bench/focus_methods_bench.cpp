// The focus methods and ray tracing for `samples/scenes/bars.toml` (50 mm f/1.4, focus at 5 m) in one run, on
// 2 threads, from opening the sample file to the image. `read` only reads and checks the records. The light
// field is timed with 32, 64 and 128 views and at three image sizes, to show that its cost is linear in both.
#include <benchmark/benchmark.h>
#include <filesystem>
#include <map>
#include <unistd.h>

#include "core/threads.h"
#include "focus/focus.h"
#include "tracer/render.h"
#include "tracer/trace.h"

namespace {

using namespace postlens;

constexpr int threads = 2;
constexpr ThinLens lens{.focal_length_mm = 50, .f_number = 1.4};
constexpr double focus_m = 5;

const Scene& bars() {
    static const Scene scene = read_scene(std::filesystem::path(POSTLENS_SAMPLES) / "scenes" / "bars.toml");
    return scene;
}

/// Path of a sample file of the given width. It is traced at the first call and removed at exit.
const std::filesystem::path& traced(int width) {
    struct Frames {
        std::map<int, std::filesystem::path> paths;
        ~Frames() {
            for (const auto& [at, path] : paths) {
                std::error_code ignored;
                std::filesystem::remove(path, ignored);
            }
        }
    };
    static Frames frames;
    auto& path = frames.paths[width];
    if (path.empty()) {
        path = std::filesystem::temp_directory_path() /
               ("postlens_focus_methods_bench_" + std::to_string(::getpid()) + "_" + std::to_string(width) +
                ".exr");
        TraceSettings s;
        s.camera.width = width;
        s.camera.height = width * 9 / 16;
        s.subdivision.levels = 3;
        s.overscan_auto = true;
        s.for_f_number = lens.f_number;
        s.for_focus_m = focus_m;
        trace_to_file(bars(), s, path);
    }
    return path;
}

void read(benchmark::State& state) {
    const ThreadLimit limit(threads);
    const auto& path = traced(960);
    for (auto _ : state) {
        const SampleFileReader file(path);
        RecordBand band;
        for (int y = file.y_begin(); y < file.y_end(); y += 64) {
            file.read(y, std::min(y + 64, file.y_end()), band);
            benchmark::DoNotOptimize(band.records.data());
        }
    }
}

void focus(benchmark::State& state, FocusMethod method) {
    const ThreadLimit limit(threads);
    const auto& path = traced(static_cast<int>(state.range(0)));
    for (auto _ : state) {
        const SampleFileReader file(path);
        const FocusResult r =
            focus_picture(file, {.lens = lens,
                                 .focus_distance_m = focus_m,
                                 .method = method,
                                 .views = static_cast<int>(std::max<long>(state.range(1), 1))});
        benchmark::DoNotOptimize(r.image.rgb.data());
    }
}

void rays(benchmark::State& state) {
    const ThreadLimit limit(threads);
    RenderSettings s;
    s.f_number = lens.f_number;
    s.focal_length_mm = lens.focal_length_mm;
    s.focus_m = focus_m;
    s.spp = static_cast<int>(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(render_picture(bars(), s).image.rgb.data());
}

BENCHMARK(read)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(focus, scatter, FocusMethod::scatter)
    ->Args({960, 0})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(focus, layers, FocusMethod::layers)
    ->Args({960, 0})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(focus, lightfield, FocusMethod::lightfield)
    ->ArgsProduct({{960}, {32, 64, 128, 256}})
    ->Args({480, 64})
    ->Args({1920, 64})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(rays)->Arg(64)->Arg(256)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
