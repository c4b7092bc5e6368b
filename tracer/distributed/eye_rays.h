// Makes the eye rays of given pixels, and renders given pixels.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tracer/distributed/render_setup.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

/// Writes to `eye` the eye rays of samples [first, first + count) of each pixel (index y * width + x), one
/// pixel after the other. `times`: true if the rays need their instants.
void make_eye_rays(const RenderSetup& setup, const Sampler& sampler, bool times,
                   std::span<const std::uint32_t> pixels, int first, int count, EyeRays& eye);

/// Colours of the given pixels. Except for rounding, the colours equal those of `render_picture` with the
/// same settings. The settings `halves` and `resume` are ignored. The colours are bit-identical for any
/// number of threads.
struct RenderedPixels {
    std::vector<std::array<float, 3>> rgb;
    RayCounts rays;
};
[[nodiscard]] RenderedPixels render_pixels(const Scene& scene, const RenderSettings& settings,
                                           std::span<const std::uint32_t> pixels);

}  // namespace postlens
