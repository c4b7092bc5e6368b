// The eye rays of some pixels, and pixels rendered one by one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tracer/distributed_tracer.h"
#include "tracer/render_setup.h"

namespace postlens {

/// Samples [first, first + count) of each of the pixels (y * width + x), pixel by pixel, into `eye`.
/// `times`: whether rays need theirs.
void make_eye_rays(const RenderSetup& setup, const Sampler& sampler, bool times,
                   std::span<const std::uint32_t> pixels, int first, int count, EyeRays& eye);

/// Colours of some pixels, as `render_picture` with these settings gives them but for rounding; `halves` and
/// `resume` do not count. Same bits for any number of threads.
struct RenderedPixels {
    std::vector<std::array<float, 3>> rgb;
    RayCounts rays;
};
[[nodiscard]] RenderedPixels render_pixels(const Scene& scene, const RenderSettings& settings,
                                           std::span<const std::uint32_t> pixels);

}  // namespace postlens
