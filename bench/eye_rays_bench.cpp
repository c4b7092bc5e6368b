// The tracer's eye rays compared to a bare Embree loop over the same rays, and whole images
// of the SPD scenes.
//   eye_rays_bench --benchmark_enable_random_interleaving=true --benchmark_repetitions=5
// The environment variable POSTLENS_SPD names the folder of balls.nff, tetra.nff and mount.nff.
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
#include "tracer/camera_model.h"
#include "tracer/intersection/ray_scene.h"
#include "tracer/recording/corner_sampler.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {
namespace {

namespace fs = std::filesystem;

struct Prepared {
    explicit Prepared(Scene s, int width, int height)
        : scene(std::move(s)),
          rays(scene, 0),
          camera(scene.cameras.at(0), 0, {.width = width, .height = height}) {}
    Scene scene;
    RayScene rays;
    CameraModel camera;
};

fs::path spd(const std::string& name) {
    const char* folder = std::getenv("POSTLENS_SPD");
    return fs::path(folder != nullptr ? folder : ".") / (name + ".nff");
}

Prepared& prepared(const std::string& name, int width, int height) {
    static std::map<std::string, std::unique_ptr<Prepared>> all;
    auto& p = all[name + std::to_string(width)];
    if (!p)
        p = std::make_unique<Prepared>(name == "mesh" ? mesh_scene(1'000'000) : read_scene(spd(name)), width,
                                       height);
    return *p;
}

bool missing(benchmark::State& state, const std::string& name) {
    if (name == "mesh" || fs::exists(spd(name))) return false;
    state.SkipWithError("set POSTLENS_SPD to the folder of the SPD scenes");
    return true;
}

constexpr int width = 1920, height = 1080, tile = 16;
struct Tile {
    int x, y;
};
std::vector<Tile> tiles() {
    std::vector<Tile> out;
    for (int y = 0; y <= height; y += tile) {
        for (int x = 0; x <= width; x += tile) out.push_back({x, y});
    }
    return out;
}

// Visits the pixel corners of a tile in blocks of 4 x 4, in the order of the tracer.
template <typename Visit>
void corners(const Tile& t, const Visit& visit) {
    for (int by = t.y; by < t.y + tile; by += 4) {
        for (int bx = t.x; bx < t.x + tile; bx += 4) {
            for (int i = 0; i < 16; ++i) visit(bx + i % 4, by + i / 4);
        }
    }
}

void report(benchmark::State& state, std::uint64_t hits) {
    const auto rays = static_cast<double>(tiles().size() * tile * tile);
    state.counters["rays/s"] = benchmark::Counter(rays, benchmark::Counter::kIsIterationInvariantRate);
    state.counters["hit_share"] = static_cast<double>(hits) / rays;
}

// Lower bound for the cost of eye rays: makes packets of 16 rays, intersects them with
// Embree and counts hits.
void bare_embree(benchmark::State& state, const std::string& name) {
    if (missing(state, name)) return;
    const Prepared& p = prepared(name, width, height);
    auto* scene = static_cast<RTCScene>(p.rays.native_handle());
    const CameraModel& c = p.camera;
    const glm::vec3 o(c.position), right(c.right), down(c.down), forward(c.forward);
    const auto scale = static_cast<float>(c.pixel_pitch_mm / c.film_distance_mm);
    const std::vector<Tile> all = tiles();
    std::uint64_t hits = 0;
    for (auto _ : state) {
        std::atomic<std::uint64_t> sum{0};
        parallel_for(all.size(), [&](std::size_t t) {
            RTCIntersectContext context{};
            rtcInitIntersectContext(&context);
            context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
            RTCRayHit16 r;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled lane by lane below
            alignas(64) int valid[16];
            std::uint64_t count = 0;
            int i = 0;
            corners(all[t], [&](int x, int y) {
                const float px = (static_cast<float>(x) - 0.5F * width) * scale,
                            py = (static_cast<float>(y) - 0.5F * height) * scale;
                glm::vec3 d = forward + px * right + py * down;
                d *= 1 / std::sqrt(glm::dot(d, d));
                r.ray.org_x[i] = o.x, r.ray.org_y[i] = o.y, r.ray.org_z[i] = o.z;
                r.ray.dir_x[i] = d.x, r.ray.dir_y[i] = d.y, r.ray.dir_z[i] = d.z;
                r.ray.tnear[i] = 0, r.ray.tfar[i] = std::numeric_limits<float>::infinity();
                r.ray.time[i] = 0, r.ray.mask[i] = ~0U, r.ray.id[i] = static_cast<unsigned>(i),
                r.ray.flags[i] = 0;
                r.hit.geomID[i] = r.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
                valid[i] = -1;
                if (++i < 16) return;
                i = 0;
                // The callbacks of the scene's user geometries expect postlens' context, which begins with
                // Embree's and has further members.
                struct {
                    RTCIntersectContext base;
                    void* none[4];
                } extended{context, {}};
                rtcIntersect16(valid, scene, &extended.base, &r);
                for (const unsigned id : r.hit.geomID) count += id != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
            });
            sum += count;
        });
        hits = sum;
    }
    report(state, hits);
}

// The tracer's eye rays: double-precision camera model, ray batches, hits stored.
void eye_rays(benchmark::State& state, const std::string& name) {
    if (missing(state, name)) return;
    const Prepared& p = prepared(name, width, height);
    const std::vector<Tile> all = tiles();
    std::uint64_t hits = 0;
    for (auto _ : state) {
        std::atomic<std::uint64_t> sum{0};
        parallel_for(all.size(), [&](std::size_t t) {
            thread_local RayBatch batch;
            batch.clear(false);
            corners(all[t], [&](int x, int y) {
                const CameraRay r = p.camera.ray(x, y);
                batch.add(r.origin, r.direction, std::numeric_limits<float>::infinity());
            });
            p.rays.intersect(batch, true);
            std::uint64_t count = 0;
            for (int i = 0; i < batch.count; ++i)
                count += batch.hit(static_cast<std::size_t>(i)).valid() ? 1 : 0;
            sum += count;
        });
        hits = sum;
    }
    report(state, hits);
}

// The work of `trace` for primary hits, without the file: records with normals, depth and colour.
void eye_records(benchmark::State& state, const std::string& name) {
    if (missing(state, name)) return;
    const Prepared& p = prepared(name, width, height);
    const WhittedTracer tracer(p.rays, p.camera, {.max_depth = 1});
    const std::vector<Tile> all = tiles();
    std::uint64_t hits = 0;
    for (auto _ : state) {
        std::atomic<std::uint64_t> sum{0};
        parallel_for(all.size(), [&](std::size_t t) {
            thread_local TracedSamples out;
            thread_local std::vector<glm::dvec2> at;
            at.clear();
            corners(all[t], [&](int x, int y) { at.emplace_back(x, y); });
            RayCounts counts;
            tracer.trace(at, out, counts);
            sum += counts.eye_hits;
        });
        hits = sum;
    }
    report(state, hits);
}

// A whole image of an SPD scene with 513 x 513 corner rays and up to 5 nodes per path. Includes reading the
// scene, building its acceleration structure and tracing. Excludes writing a file and computing W, which an
// image does not need. spd_trace_only excludes reading and building, and computes W as `trace` does.
void spd_picture(benchmark::State& state, const std::string& name) {
    if (missing(state, name)) return;
    RayCounts counts;
    for (auto _ : state) {
        const Scene scene = read_scene(spd(name));
        const RayScene rays(scene, 0);
        const CameraModel camera(scene.cameras.at(0), 0, {.width = 512, .height = 512});
        const WhittedTracer tracer(rays, camera,
                                   {.max_depth = 5, .min_contribution = 0, .refocus_matrices = false});
        counts = sample_corners(tracer, {0, 512, 0, 512}, {.levels = 0}, [](const RecordBand&) {});
    }
    const auto rays = static_cast<double>(counts.eye + counts.reflect + counts.refract + counts.shadow);
    state.counters["rays/s"] = benchmark::Counter(rays, benchmark::Counter::kIsIterationInvariantRate);
}

void spd_trace_only(benchmark::State& state, const std::string& name) {
    if (missing(state, name)) return;
    const Prepared& p = prepared(name, 512, 512);
    const WhittedTracer tracer(p.rays, p.camera, {.max_depth = 5, .min_contribution = 0});
    RayCounts counts;
    for (auto _ : state) {
        counts = sample_corners(tracer, {0, 512, 0, 512}, {.levels = 0}, [](const RecordBand&) {});
    }
    const auto rays = static_cast<double>(counts.eye + counts.reflect + counts.refract + counts.shadow);
    state.counters["rays/s"] = benchmark::Counter(rays, benchmark::Counter::kIsIterationInvariantRate);
}

#define POSTLENS_BENCH(function, scene) \
    BENCHMARK_CAPTURE(function, scene, #scene)->Unit(benchmark::kMillisecond)->UseRealTime()
POSTLENS_BENCH(bare_embree, mesh);
POSTLENS_BENCH(eye_rays, mesh);
POSTLENS_BENCH(eye_records, mesh);
POSTLENS_BENCH(bare_embree, balls);
POSTLENS_BENCH(eye_rays, balls);
POSTLENS_BENCH(eye_records, balls);
POSTLENS_BENCH(spd_picture, balls);
POSTLENS_BENCH(spd_trace_only, balls);
POSTLENS_BENCH(spd_picture, tetra);
POSTLENS_BENCH(spd_trace_only, tetra);
POSTLENS_BENCH(spd_picture, mount);
POSTLENS_BENCH(spd_trace_only, mount);

}  // namespace
}  // namespace postlens
