// Distributed ray tracing compared to a bare Embree loop over the same rays, and whole images.
//   render_bench --benchmark_enable_random_interleaving=true --benchmark_repetitions=5
// The environment variable POSTLENS_SPD names the folder of balls.nff, POSTLENS_SAMPLES the folder
// samples/scenes. The Embree loop traces single rays, packets of 8 and 16 rays with and without the coherent
// flag, or streams.
#include <atomic>
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdlib>
#include <embree3/rtcore.h>
#include <filesystem>
#include <map>
#include <memory>

#include "bench/mesh_scene.h"
#include "core/threads.h"
#include "tracer/distributed/lens_camera.h"
#include "tracer/render.h"
#include "tracer/sampling/sampler.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

fs::path from_environment(const char* variable, const std::string& file) {
    const char* folder = std::getenv(variable);
    return fs::path(folder != nullptr ? folder : ".") / file;
}

constexpr int width = 960, height = 540, spp = 16, tile = 8;

struct Prepared {
    Prepared(Scene s, double aperture_radius_m, double focus_m)
        : scene(std::move(s)),
          model(scene.cameras.at(0), 0, {.width = width, .height = height}),
          camera(scene.cameras.at(0), model,
                 {.lens = {aperture_radius_m, 1 / focus_m, 1 / model.tangent_per_px, 1}, .span = {0, 1}}),
          rays(scene, TimeSpan{0, 1},
               {[this](const glm::dvec3& p, double t) { return camera.px_per_m(p, t); }}),
          sampler(SamplerKind::sobol, spp, 0),
          tracer(rays, sampler, {.max_depth = 1}) {}
    Prepared(const Prepared&) = delete;
    Prepared& operator=(const Prepared&) = delete;
    Prepared(Prepared&&) = delete;
    Prepared& operator=(Prepared&&) = delete;
    ~Prepared() = default;

    Scene scene;
    CameraModel model;
    LensCamera camera;
    RayScene rays;
    Sampler sampler;
    DistributedTracer tracer;

    // Makes the eye rays of a tile in the same way as `render`.
    void make_rays(std::size_t index, RayBatch& batch) const {
        constexpr std::size_t columns = width / tile;
        const int x0 = static_cast<int>(index % columns) * tile,
                  y0 = static_cast<int>(index / columns) * tile;
        batch.clear(false, tracer.needs_times());
        Sampler::EyeSamples n;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
        LensSamples s;          // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
        std::vector<float> weights;
        for (int y = y0; y < y0 + tile; ++y) {
            for (int x = x0; x < x0 + tile; ++x) {
                sampler.fill_eye(static_cast<std::uint32_t>(y * width + x), 0, spp, n);
                for (std::size_t i = 0; i < spp; ++i) {
                    s.x[i] = static_cast<float>(x) + n.pixel_u[i];
                    s.y[i] = static_cast<float>(y) + n.pixel_v[i];
                    s.lens_u[i] = n.lens_u[i];
                    s.lens_v[i] = n.lens_v[i];
                    s.time[i] = n.time_u[i];
                }
                camera.add_rays(s, batch, weights);
            }
        }
    }
};
constexpr std::size_t tiles = std::size_t{width / tile} * (height / tile);

Prepared& prepared(const std::string& name) {
    static std::map<std::string, std::unique_ptr<Prepared>> all;
    auto& p = all[name];
    if (p) return *p;
    if (name == "balls") {
        p = std::make_unique<Prepared>(read_scene(from_environment("POSTLENS_SPD", "balls.nff")), 0.05, 2.5);
    } else {
        Scene scene = mesh_scene(1'000'000);
        if (name == "moving_mesh") {
            scene.objects[0].keys = {
                {0}, {1, {0.1, 0, 0}, glm::angleAxis(glm::radians(10.0), glm::dvec3(0, 0, 1))}};
        }
        p = std::make_unique<Prepared>(std::move(scene), name == "pinhole_mesh" ? 0.0 : 0.05, 3);
    }
    return *p;
}

bool missing(benchmark::State& state, const std::string& name) {
    if (name != "balls" || fs::exists(from_environment("POSTLENS_SPD", "balls.nff"))) return false;
    state.SkipWithError("set POSTLENS_SPD to the folder of balls.nff");
    return true;
}

void report(benchmark::State& state, std::uint64_t hits) {
    const auto rays = static_cast<double>(tiles * tile * tile * spp);
    state.counters["rays/s"] = benchmark::Counter(rays, benchmark::Counter::kIsIterationInvariantRate);
    state.counters["hit_share"] = static_cast<double>(hits) / rays;
}

// The callbacks of the scene's user geometries expect postlens' context, which begins with Embree's
// and has further members.
struct Context {
    RTCIntersectContext base;
    void* none[4];
};

template <typename Body>
void over_tiles(benchmark::State& state, const Body& body) {
    std::uint64_t hits = 0;
    for (auto _ : state) {
        std::atomic<std::uint64_t> sum{0};
        parallel_for(tiles, [&](std::size_t t) { sum += body(t); });
        hits = sum;
    }
    report(state, hits);
}

// Eye rays of all tiles, made once, so that bare_embree measures Embree's part alone.
std::vector<RayBatch>& made(const std::string& name) {
    static std::map<std::string, std::vector<RayBatch>> all;
    std::vector<RayBatch>& batches = all[name];
    if (batches.empty()) {
        batches.resize(tiles);
        for (std::size_t t = 0; t < tiles; ++t) prepared(name).make_rays(t, batches[t]);
    }
    return batches;
}

template <typename Packet>
void load(const RayBatch& b, std::size_t first, std::size_t n, Packet& p) {
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t k = first + i;
        p.ray.org_x[i] = b.ox[k], p.ray.org_y[i] = b.oy[k], p.ray.org_z[i] = b.oz[k];
        p.ray.dir_x[i] = b.dx[k], p.ray.dir_y[i] = b.dy[k], p.ray.dir_z[i] = b.dz[k];
        p.ray.tnear[i] = 0, p.ray.tfar[i] = std::numeric_limits<float>::infinity();
        p.ray.time[i] = b.has_times ? b.time[k] : 0.0F;
        p.ray.mask[i] = ~0U, p.ray.id[i] = static_cast<unsigned>(i), p.ray.flags[i] = 0;
        p.hit.geomID[i] = p.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
}

RTCRayHit single_ray(const RayBatch& b, std::size_t k) {
    RTCRayHit r{};
    r.ray.org_x = b.ox[k], r.ray.org_y = b.oy[k], r.ray.org_z = b.oz[k];
    r.ray.dir_x = b.dx[k], r.ray.dir_y = b.dy[k], r.ray.dir_z = b.dz[k];
    r.ray.tfar = std::numeric_limits<float>::infinity();
    r.ray.time = b.has_times ? b.time[k] : 0.0F;
    r.ray.mask = ~0U;
    r.ray.id = static_cast<unsigned>(k);
    r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return r;
}

enum class Way { packet16_coherent, packet16, packet8_coherent, single, stream };

void bare_embree(benchmark::State& state, const std::string& name, Way way) {
    if (missing(state, name)) return;
    auto* scene = static_cast<RTCScene>(prepared(name).rays.native_handle());
    const std::vector<RayBatch>& batches = made(name);
    over_tiles(state, [&](std::size_t t) {
        Context context{};
        rtcInitIntersectContext(&context.base);
        const bool coherent = way == Way::packet16_coherent || way == Way::packet8_coherent;
        if (coherent) context.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        alignas(64) int valid[16];
        std::fill_n(valid, 16, -1);
        const RayBatch& b = batches[t];
        std::uint64_t count = 0;
        if (way == Way::stream) {
            thread_local std::vector<RTCRayHit> rays;
            rays.clear();
            for (std::size_t k = 0; k < static_cast<std::size_t>(b.count); ++k)
                rays.push_back(single_ray(b, k));
            rtcIntersect1M(scene, &context.base, rays.data(), static_cast<unsigned>(rays.size()),
                           sizeof(RTCRayHit));
            for (const RTCRayHit& r : rays) count += r.hit.geomID != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
            return count;
        }
        for (std::size_t first = 0; first < static_cast<std::size_t>(b.count); first += 16) {
            if (way == Way::single) {
                for (std::size_t k = first; k < first + 16; ++k) {
                    RTCRayHit r = single_ray(b, k);
                    rtcIntersect1(scene, &context.base, &r);
                    count += r.hit.geomID != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
                }
            } else if (way == Way::packet8_coherent) {
                for (std::size_t half = 0; half < 2; ++half) {
                    RTCRayHit8 r;  // NOLINT(cppcoreguidelines-pro-type-member-init): `load` fills it
                    load(b, first + 8 * half, 8, r);
                    rtcIntersect8(valid, scene, &context.base, &r);
                    for (const unsigned id : r.hit.geomID) count += id != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
                }
            } else {
                RTCRayHit16 r;  // NOLINT(cppcoreguidelines-pro-type-member-init): `load` fills it
                load(b, first, 16, r);
                rtcIntersect16(valid, scene, &context.base, &r);
                for (const unsigned id : r.hit.geomID) count += id != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
            }
        }
        return count;
    });
}

// The eye rays of `render`: random numbers, lens, rays and hits.
void eye_rays(benchmark::State& state, const std::string& name) {
    if (missing(state, name)) return;
    const Prepared& p = prepared(name);
    over_tiles(state, [&](std::size_t t) {
        thread_local RayBatch batch;
        p.make_rays(t, batch);
        p.rays.intersect(batch, p.tracer.coherent());
        std::uint64_t count = 0;
        for (int i = 0; i < batch.count; ++i) count += batch.hit(static_cast<std::size_t>(i)).valid() ? 1 : 0;
        return count;
    });
}

// Random numbers and rays, without hits.
void ray_making(benchmark::State& state, const std::string& name) {
    if (missing(state, name)) return;
    const Prepared& p = prepared(name);
    over_tiles(state, [&](std::size_t t) {
        thread_local RayBatch batch;
        p.make_rays(t, batch);
        benchmark::DoNotOptimize(batch.dx.data());
        return 0U;
    });
}

// The whole of `render` without its files, on a scene that only emits, so that each sample is one ray.
void picture(benchmark::State& state, const std::string& file, double f_number, bool shutter) {
    const fs::path path = from_environment("POSTLENS_SAMPLES", file);
    if (!fs::exists(path)) {
        state.SkipWithError("set POSTLENS_SAMPLES to the folder samples/scenes");
        return;
    }
    const Scene scene = read_scene(path);
    RenderSettings settings;
    settings.camera.width = width;
    settings.camera.height = height;
    settings.spp = 64;
    settings.f_number = f_number;
    if (shutter) settings.shutter = TimeSpan{0, 1};
    double rays = 0, seconds = 0;
    for (auto _ : state) {
        const RenderResult r = render_picture(scene, settings);
        rays += static_cast<double>(r.rays.eye);
        seconds += r.seconds_render;
    }
    state.counters["samples/s"] = rays / seconds;
}

#define POSTLENS_SCENE(scene)                                                                 \
    BENCHMARK_CAPTURE(bare_embree, scene##_16_coherent, #scene, Way::packet16_coherent)       \
        ->Unit(benchmark::kMillisecond)                                                       \
        ->UseRealTime();                                                                      \
    BENCHMARK_CAPTURE(bare_embree, scene##_16, #scene, Way::packet16)                         \
        ->Unit(benchmark::kMillisecond)                                                       \
        ->UseRealTime();                                                                      \
    BENCHMARK_CAPTURE(bare_embree, scene##_8_coherent, #scene, Way::packet8_coherent)         \
        ->Unit(benchmark::kMillisecond)                                                       \
        ->UseRealTime();                                                                      \
    BENCHMARK_CAPTURE(bare_embree, scene##_1, #scene, Way::single)                            \
        ->Unit(benchmark::kMillisecond)                                                       \
        ->UseRealTime();                                                                      \
    BENCHMARK_CAPTURE(bare_embree, scene##_stream, #scene, Way::stream)                       \
        ->Unit(benchmark::kMillisecond)                                                       \
        ->UseRealTime();                                                                      \
    BENCHMARK_CAPTURE(eye_rays, scene, #scene)->Unit(benchmark::kMillisecond)->UseRealTime(); \
    BENCHMARK_CAPTURE(ray_making, scene, #scene)->Unit(benchmark::kMillisecond)->UseRealTime()
POSTLENS_SCENE(mesh);
POSTLENS_SCENE(pinhole_mesh);
POSTLENS_SCENE(moving_mesh);
POSTLENS_SCENE(balls);
BENCHMARK_CAPTURE(picture, bars_lens, "bars.toml", 1.4, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(picture, motion, "motion.toml", std::numeric_limits<double>::infinity(), true)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(picture, bars_pinhole, "bars.toml", std::numeric_limits<double>::infinity(), false)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace postlens
