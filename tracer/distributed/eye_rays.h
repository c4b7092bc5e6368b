// Makes the eye rays of given pixels.
#pragma once

#include <cstdint>
#include <span>

#include "tracer/distributed/render_setup.h"
#include "tracer/shading_trees/distributed_tracer.h"

namespace postlens {

/// Writes the eye rays for samples [first, first + count) of each pixel to `eye`, pixel by pixel.
/// `pixels` contains indices y * width + x. With `times`, every ray has the time of its sample.
void make_eye_rays(const RenderSetup& setup, const Sampler& sampler, bool times,
                   std::span<const std::uint32_t> pixels, int first, int count, EyeRays& eye);

}  // namespace postlens
