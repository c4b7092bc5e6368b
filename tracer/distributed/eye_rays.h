// Makes the eye rays of given pixels.
#pragma once

#include <cstdint>
#include <span>

#include "tracer/distributed/render_setup.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

/// Writes to `eye` the eye rays of samples [first, first + count) of each pixel, one pixel after the other.
/// The index of a pixel is y * width + x. `times` is true if the rays need their instants.
void make_eye_rays(const RenderSetup& setup, const Sampler& sampler, bool times,
                   std::span<const std::uint32_t> pixels, int first, int count, EyeRays& eye);

}  // namespace postlens
