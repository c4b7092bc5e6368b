// A sweep of 64 images of `samples/scenes/bars.toml` (960x540, 50 mm, 8 f-numbers times 8 focus distances)
// from one sample file, which it reads once, compared to 64 single calls that each open the file. Images of
// both are made in turns, so that they see the same load of the machine, on 2 threads, and are not written.
// `calls_s` and `sweep_s`: total seconds; `ratio`: calls_s / sweep_s.
#include <benchmark/benchmark.h>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <unistd.h>

#include "core/threads.h"
#include "sweep/picture_maker.h"
#include "tracer/trace.h"

namespace {

using namespace postlens;
using Clock = std::chrono::steady_clock;

constexpr int threads = 2;

/// A temporary sample file, which the destructor removes.
class FrameFile {
  public:
    FrameFile()
        : path_(std::filesystem::temp_directory_path() /
                ("postlens_sweep_bench_" + std::to_string(::getpid()) + ".exr")) {
        const Scene scene = read_scene(std::filesystem::path(POSTLENS_SAMPLES) / "scenes" / "bars.toml");
        TraceSettings s;
        s.camera.width = 960;
        s.camera.height = 540;
        s.overscan_auto = true;
        s.for_f_number = 1.4;
        s.for_focus_m = 2;
        s.subdivide_for_lens = true;
        trace_to_file(scene, s, path_);
    }
    ~FrameFile() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    FrameFile(const FrameFile&) = delete;
    FrameFile& operator=(const FrameFile&) = delete;
    FrameFile(FrameFile&&) = delete;
    FrameFile& operator=(FrameFile&&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

void sweep_against_calls(benchmark::State& state, FocusMethod method) {
    static const FrameFile frame;
    const ThreadLimit limit(threads);
    SweepAxes axes{.focal_lengths_mm = {50}};
    for (int i = 0; i < 8; ++i) {
        axes.f_numbers.push_back(1.4 * std::exp2(i / 2.0));
        axes.focus_m.push_back(1 / (0.1 + 0.4 * i / 7));  // 10 m to 2 m
    }
    const SweepGrid grid = sweep_grid(axes);
    double calls_s = 0, sweep_s = 0;
    for (auto _ : state) {
        auto start = Clock::now();
        const SampleFileReader file(frame.path());
        PictureMaker maker(file, {.method = method}, false);
        sweep_s += seconds_since(start);
        for (const SweepSetting& s : grid.pictures) {
            start = Clock::now();
            const MadePicture made = maker.make(s);
            sweep_s += seconds_since(start);
            start = Clock::now();
            const SampleFileReader alone(frame.path());
            const FocusResult single = focus_picture(
                alone,
                {.lens = {s.focal_length_mm, s.f_number}, .focus_distance_m = s.focus_m, .method = method});
            calls_s += seconds_since(start);
            if (made.image.rgb != single.image.rgb) state.SkipWithError("the pictures differ");
        }
    }
    state.counters["pictures"] = static_cast<double>(grid.pictures.size());
    state.counters["calls_s"] = calls_s / static_cast<double>(state.iterations());
    state.counters["sweep_s"] = sweep_s / static_cast<double>(state.iterations());
    state.counters["ratio"] = calls_s / sweep_s;
}

BENCHMARK_CAPTURE(sweep_against_calls, scatter, FocusMethod::scatter)
    ->Iterations(1)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(sweep_against_calls, layers, FocusMethod::layers)->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(sweep_against_calls, lightfield, FocusMethod::lightfield)
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace
