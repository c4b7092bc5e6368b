// Makes the eye rays of given pixels.
#pragma once

#include <cstdint>
#include <span>

#include "tracer/distributed/render_setup.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

/// Writes to `eye` the eye rays for samples [first, first + count) of each pixel, pixel by pixel. `pixels`
/// contains pixel indices y * width + x. If `times` is true, every ray also gets the time of its sample.
void make_eye_rays(const RenderSetup& setup, const Sampler& sampler, bool times,
                   std::span<const std::uint32_t> pixels, int first, int count, EyeRays& eye);

}  // namespace postlens
