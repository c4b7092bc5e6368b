// Motion blur at 1920x1080: three moving objects of about 300 px on paths of 120 px before a static wall,
// from opening the sample file to the image, on 2 threads. `read` only reads and checks the records, which is
// a lower bound for the time of convolve.
#include <benchmark/benchmark.h>
#include <filesystem>
#include <unistd.h>

#include "core/threads.h"
#include "motionblur/motion_blur.h"
#include "tests/support/scene_builder.h"
#include "tracer/trace.h"

namespace {

using namespace postlens;

constexpr int threads = 2;
constexpr double px_per_m_at_1m = 1920 / 36.0 * 50;

std::filesystem::path frame(int levels, bool packed) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                       ("postlens_motion_blur_bench_" + std::to_string(::getpid()) + "_" +
                                        std::to_string(levels) + (packed ? "_zips" : "_none") + ".exr");
    test::SceneBuilder scene;
    scene.scene.cameras[0].width = 1920;
    scene.scene.cameras[0].height = 1080;
    for (int i = -8; i < 8; ++i) {
        const double shade = i % 2 == 0 ? 0.7 : 0.2;
        scene.add(Rectangle{{i * 0.4, -3, -8}, {0.4, 0, 0}, {0, 6, 0}}, test::glowing(glm::dvec3(shade)));
    }
    const double m_per_px = 4 / px_per_m_at_1m;
    const double way = 120 * m_per_px;
    for (int i = 0; i < 3; ++i) {
        const double x = (i - 1) * 560 * m_per_px, half = 150 * m_per_px;
        const double angle = 0.4 * i;
        scene.add(Disc{{x, 0, -4}, {0, 0, 1}, half, 0}, test::glowing({0.9, 0.3 * i, 0.2})).keys = {
            {.time_s = 0}, {.time_s = 1, .translation = {way * std::cos(angle), way * std::sin(angle), 0}}};
    }
    TraceSettings settings;
    settings.subdivision.levels = levels;
    settings.for_shutter = TimeSpan{0, 1};
    settings.compression = packed ? RecordCompression::zips : RecordCompression::none;
    trace_to_file(scene.scene, settings, path);
    return path;
}

/// Path of a sample file. It is traced at the first call and removed at exit.
const std::filesystem::path& traced(const benchmark::State& state) {
    const auto levels = static_cast<int>(state.range(0));
    const bool packed = state.range(1) != 0;
    struct Frames {
        std::array<std::filesystem::path, 10> paths;
        ~Frames() {
            for (const auto& p : paths) {
                std::error_code ignored;
                if (!p.empty()) std::filesystem::remove(p, ignored);
            }
        }
    };
    static Frames frames;
    auto& path = frames.paths.at(static_cast<std::size_t>(2 * levels + (packed ? 1 : 0)));
    if (path.empty()) path = frame(levels, packed);
    return path;
}

void read(benchmark::State& state) {
    const ThreadLimit limit(threads);
    const auto& path = traced(state);
    for (auto _ : state) {
        const SampleFileReader file(path);
        RecordBand band;
        for (int y = file.y_begin(); y < file.y_end(); y += 64) {
            file.read(y, std::min(y + 64, file.y_end()), band);
            benchmark::DoNotOptimize(band.records.data());
        }
    }
}

void blur(benchmark::State& state, MotionMethod method) {
    const ThreadLimit limit(threads);
    const auto& path = traced(state);
    for (auto _ : state) {
        const SampleFileReader file(path);
        const MotionBlurResult result = motion_blur(file, {.exposure = {0, 1}, .method = method});
        benchmark::DoNotOptimize(result.image.rgb.data());
    }
}

void convolve(benchmark::State& state) {
    blur(state, MotionMethod::convolve);
}
void lightfield(benchmark::State& state) {
    blur(state, MotionMethod::lightfield);
}

BENCHMARK(read)
    ->ArgNames({"levels", "zips"})
    ->ArgsProduct({{0, 2}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(convolve)
    ->ArgNames({"levels", "zips"})
    ->ArgsProduct({{0, 2}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(lightfield)
    ->ArgNames({"levels", "zips"})
    ->ArgsProduct({{0, 2}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
