// Makes the eye rays of given pixels.
#pragma once

#include <cstdint>
#include <span>

#include "tracer/distributed/render_setup.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

/// Writes the eye rays for samples [first, first + count) of each pixel to `eye`.
/// `pixels` contains indices y * width + x. If `times` is true, the rays have times.
void make_eye_rays(const RenderSetup& setup, const Sampler& sampler, bool times,
                   std::span<const std::uint32_t> pixels, int first, int count, EyeRays& eye);

}  // namespace postlens
