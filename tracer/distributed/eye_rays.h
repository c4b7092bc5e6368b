// Makes the eye rays of given pixels.
#pragma once

#include <cstdint>
#include <span>

#include "tracer/distributed/render_setup.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

/// Stores in `eye` the eye rays for the samples `first` to `first` + `count` - 1 of each pixel in `pixels`.
/// The pixel (x, y) is given as the index y * width + x. If `times` is true, each ray has its own instant
/// within the exposure.
void make_eye_rays(const RenderSetup& setup, const Sampler& sampler, bool times,
                   std::span<const std::uint32_t> pixels, int first, int count, EyeRays& eye);

}  // namespace postlens
