#include "tracer/distributed/eye_rays.h"

#include <algorithm>

#include "core/threads.h"

namespace postlens {

void make_eye_rays(const RenderSetup& setup, const Sampler& sampler, bool times,
                   std::span<const std::uint32_t> pixels, int first, int count, EyeRays& eye) {
    eye.rays.clear(false, times);
    eye.pixel.clear();
    eye.index.clear();
    eye.weight.clear();
    Sampler::EyeSamples numbers;  // NOLINT(cppcoreguidelines-pro-type-member-init): fill_eye fills it
    LensSamples samples;          // NOLINT(cppcoreguidelines-pro-type-member-init): filled lane by lane
    std::size_t lane = 0;
    const auto width = static_cast<std::uint32_t>(setup.width());
    for (const std::uint32_t pixel : pixels) {
        sampler.fill_eye(pixel, first, count, numbers);
        const auto left = static_cast<float>(pixel % width), top = static_cast<float>(pixel / width);
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            samples.x[lane] = left + numbers.pixel_u[i];
            samples.y[lane] = top + numbers.pixel_v[i];
            samples.lens_u[lane] = numbers.lens_u[i];
            samples.lens_v[lane] = numbers.lens_v[i];
            samples.time[lane] = numbers.time_u[i];
            eye.pixel.push_back(pixel);
            eye.index.push_back(first + static_cast<int>(i));
            if (++lane < 16) continue;
            setup.camera().add_rays(samples, eye.rays, eye.weight);
            lane = 0;
        }
    }
    if (lane == 0) return;
    // The last group has fewer than 16 samples. The remaining lanes are filled with zeros, and their rays are
    // dropped.
    for (std::size_t i = lane; i < 16; ++i) {
        samples.x[i] = samples.y[i] = samples.lens_u[i] = samples.lens_v[i] = samples.time[i] = 0;
    }
    setup.camera().add_rays(samples, eye.rays, eye.weight);
    eye.rays.count -= static_cast<int>(16 - lane);
}

RenderedPixels render_pixels(const Scene& scene, const RenderSettings& settings,
                             std::span<const std::uint32_t> pixels) {
    const RenderSetup setup(scene, settings);
    const Sampler sampler(settings.sampler, settings.spp, settings.seed);
    const DistributedTracer tracer(setup.rays(), sampler, settings.tracing);
    RenderedPixels out;
    out.rgb.resize(pixels.size());
    constexpr std::size_t per_task = 64;
    const std::size_t tasks = (pixels.size() + per_task - 1) / per_task;
    std::vector<RayCounts> counts(tasks);
    parallel_for(tasks, [&](std::size_t t) {
        thread_local EyeRays eye;
        const auto part = pixels.subspan(t * per_task, std::min(per_task, pixels.size() - t * per_task));
        std::vector<glm::dvec3> sums(part.size(), glm::dvec3(0));
        for (int first = 0; first < settings.spp; first += RayBatch::group) {
            const int count = std::min(RayBatch::group, settings.spp - first);
            make_eye_rays(setup, sampler, tracer.needs_times(), part, first, count, eye);
            tracer.trace(eye, counts[t]);
            for (std::size_t ray = 0; ray < part.size() * static_cast<std::size_t>(count); ++ray) {
                const double weight = eye.weight.empty() ? 1.0 : static_cast<double>(eye.weight[ray]);
                sums[ray / static_cast<std::size_t>(count)] += weight * eye.radiance[ray];
            }
        }
        for (std::size_t i = 0; i < part.size(); ++i) {
            for (int c = 0; c < 3; ++c)
                out.rgb[t * per_task + i][static_cast<std::size_t>(c)] =
                    static_cast<float>(sums[i][c] / settings.spp);
        }
    });
    for (const RayCounts& c : counts) out.rays += c;
    return out;
}

}  // namespace postlens
