// Writing and reading sample files of 1920x1080 pixels, compared to fwrite and fread of as many bytes.
//
// Each file benchmark has the arguments {records per pixel, compression: 0 none, 1 RLE, 2 ZIPS}. Its counters
// give the size of the file and the bytes of records per second.
#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "records/quadtree.h"
#include "records/sample_file.h"

namespace postlens {
namespace {

constexpr int width = 1920;
constexpr int height = 1080;
/// Number of rows that the tracer writes, and a focus method reads, at a time.
constexpr int band_rows = 64;

/// A record as of a traced frame: smooth shading with noise like a texture's, sloped surfaces, a sky.
Record record_of(int x, int y, NodePath path) {
    const auto fx = static_cast<float>(x) / width;
    const auto fy = static_cast<float>(y) / height;
    const std::uint32_t hash =
        (static_cast<std::uint32_t>(x) * 73856093U) ^ (static_cast<std::uint32_t>(y) * 19349663U);
    const float noise = static_cast<float>((hash >> 8U) & 0xFFFFU) / 65536.0F;
    Record r;
    r.x = static_cast<float>(x);
    r.y = static_cast<float>(y);
    r.path = path;
    const int object = (x / 160) % 5;
    if (y < height / 5) {
        r.z = std::numeric_limits<float>::infinity();
        r.r = r.g = 0.3F;
        r.b = 0.6F;
    } else {
        r.id = static_cast<std::uint32_t>(object + 1);
        r.z = 2.0F + static_cast<float>(object) + fx * 0.7F + fy * 1.3F;
        r.r = 0.4F + 0.3F * std::sin(9 * fx) + 0.05F * noise;
        r.g = 0.8F * r.r + 0.1F * fy;
        r.b = 0.3F * r.r;
    }
    r.w = Mat2::isotropic(1.0F / r.z);
    if (path.depth() > 0) r.w.xy = r.w.yx = 0.01F * fx;
    return r;
}

struct Frame {
    explicit Frame(int per_pixel) {
        header.width = width;
        header.height = height;
        header.film_distance_mm = header.focal_length_mm = 50;
        header.pixel_pitch_mm = 36.0 / width;
        header.has_w = per_pixel > 1;
        for (int y = 0; y <= height; y += band_rows) {
            RecordBand& band = bands.emplace_back();
            band.x_end = width + 1;
            band.y_begin = y;
            band.y_end = std::min(y + band_rows, height + 1);
            for (int row = y; row < band.y_end; ++row) {
                for (int x = 0; x <= width; ++x) {
                    NodePath path;
                    for (int n = 0; n < per_pixel; ++n) {
                        band.records.push_back(record_of(x, row, path));
                        path = path.child(NodePath::Bounce::reflected);
                    }
                    band.offsets.push_back(static_cast<std::uint32_t>(band.records.size()));
                }
            }
            records += band.records.size();
        }
    }
    SampleHeader header;
    std::vector<RecordBand> bands;
    std::uint64_t records = 0;
};

const Frame& frame_of(int per_pixel) {
    static std::unique_ptr<Frame> frame;
    static int held = 0;
    if (held != per_pixel) {
        frame.reset();
        frame = std::make_unique<Frame>(per_pixel);
        held = per_pixel;
    }
    return *frame;
}

std::filesystem::path file_path() {
    return std::filesystem::temp_directory_path() / "postlens_sample_file_bench.exr";
}

std::uint64_t write_frame(const Frame& frame, RecordCompression compression) {
    SampleFileWriter writer(file_path(), frame.header, compression);
    for (const RecordBand& band : frame.bands) writer.write(band);
    return writer.finish();
}

RecordCompression compression_of(const benchmark::State& state) {
    return static_cast<RecordCompression>(state.range(1));
}

void set_counters(benchmark::State& state, std::uint64_t file_bytes, std::uint64_t records) {
    state.counters["file_MB"] = static_cast<double>(file_bytes) / 1e6;
    state.counters["Mrecords/s"] =
        benchmark::Counter(static_cast<double>(records) / 1e6, benchmark::Counter::kIsIterationInvariantRate);
}

void write_sample_file(benchmark::State& state) {
    const Frame& frame = frame_of(static_cast<int>(state.range(0)));
    std::uint64_t bytes = 0;
    for (auto _ : state) bytes = write_frame(frame, compression_of(state));
    set_counters(state, bytes, frame.records);
    std::filesystem::remove(file_path());
}

void read_sample_file(benchmark::State& state) {
    const Frame& frame = frame_of(static_cast<int>(state.range(0)));
    const std::uint64_t bytes = write_frame(frame, compression_of(state));
    RecordBand band;
    for (auto _ : state) {
        const SampleFileReader reader(file_path());
        for (int y = reader.y_begin(); y < reader.y_end(); y += band_rows) {
            reader.read(y, std::min(y + band_rows, reader.y_end()), band);
            benchmark::DoNotOptimize(band.records.data());
        }
    }
    set_counters(state, bytes, frame.records);
    std::filesystem::remove(file_path());
}

/// Size of the uncompressed sample file, bytes. Argument 0: records per pixel.
std::size_t plain_bytes(const benchmark::State& state) {
    static std::array<std::size_t, 4> sizes{};
    std::size_t& size = sizes[static_cast<std::size_t>(state.range(0))];
    if (size == 0) size = write_frame(frame_of(static_cast<int>(state.range(0))), RecordCompression::none);
    return size;
}

void write_with_fwrite(benchmark::State& state) {
    const std::vector<char> bytes(plain_bytes(state), 1);
    for (auto _ : state) {
        std::FILE* file = std::fopen(file_path().c_str(), "wb");
        if (file == nullptr || std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) {
            state.SkipWithError("cannot write");
        }
        if (file != nullptr) std::fclose(file);
    }
    state.counters["file_MB"] = static_cast<double>(bytes.size()) / 1e6;
    std::filesystem::remove(file_path());
}

void read_with_fread(benchmark::State& state) {
    std::vector<char> bytes(plain_bytes(state), 1);
    std::FILE* file = std::fopen(file_path().c_str(), "wb");
    if (file == nullptr || std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) {
        state.SkipWithError("cannot write");
    }
    if (file != nullptr) std::fclose(file);
    for (auto _ : state) {
        file = std::fopen(file_path().c_str(), "rb");
        if (file == nullptr || std::fread(bytes.data(), 1, bytes.size(), file) != bytes.size()) {
            state.SkipWithError("cannot read");
        }
        if (file != nullptr) std::fclose(file);
        benchmark::DoNotOptimize(bytes.data());
    }
    state.counters["file_MB"] = static_cast<double>(bytes.size()) / 1e6;
    std::filesystem::remove(file_path());
}

void set_pixel_time(benchmark::State& state) {
    state.counters["s/pixel"] =
        benchmark::Counter(static_cast<double>(width) * height,
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Finds the point samples of the frame and their weights, on one thread. Argument: records per pixel.
void rebuild_quadtree(benchmark::State& state) {
    const Frame& frame = frame_of(static_cast<int>(state.range(0)));
    PointSamples samples;
    for (auto _ : state) {
        for (const RecordBand& band : frame.bands) {
            find_point_samples(band, band.y_begin, band.y_end - 1, band.y_begin, band.y_end - 1, samples);
            benchmark::DoNotOptimize(samples.samples.data());
        }
    }
    set_pixel_time(state);
}

/// Computes the pinhole image, on one thread. Argument: records per pixel.
void compute_picture(benchmark::State& state) {
    const Frame& frame = frame_of(static_cast<int>(state.range(0)));
    std::vector<float> row(static_cast<std::size_t>(width) * 3);
    for (auto _ : state) {
        for (const RecordBand& band : frame.bands) {
            for (int y = band.y_begin; y + 1 < band.y_end; ++y) picture_row(band, y, 0, width, row);
            benchmark::DoNotOptimize(row.data());
        }
    }
    set_pixel_time(state);
}

const std::vector<std::vector<std::int64_t>> file_cases{{1, 3}, {0, 1, 2}};

BENCHMARK(write_with_fwrite)->Arg(1)->Arg(3)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(read_with_fread)->Arg(1)->Arg(3)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(write_sample_file)->ArgsProduct(file_cases)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(read_sample_file)->ArgsProduct(file_cases)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(rebuild_quadtree)->Arg(1)->Arg(3)->Unit(benchmark::kMillisecond);
BENCHMARK(compute_picture)->Arg(1)->Arg(3)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace postlens
