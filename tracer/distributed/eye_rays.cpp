#include "tracer/distributed/eye_rays.h"

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
        const std::uint32_t column = pixel % width, row = pixel / width;
        const auto left = static_cast<float>(column), top = static_cast<float>(row);
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
    // The camera makes rays for groups of 16 samples. The last group may have fewer, so it is filled with
    // dummy samples. After the rays are made, those of the dummy samples are removed from `eye.rays`.
    for (std::size_t i = lane; i < 16; ++i) {
        samples.x[i] = samples.y[i] = samples.lens_u[i] = samples.lens_v[i] = samples.time[i] = 0;
    }
    setup.camera().add_rays(samples, eye.rays, eye.weight);
    eye.rays.count -= static_cast<int>(16 - lane);
}

}  // namespace postlens
