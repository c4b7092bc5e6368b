// Pixels traced again with as many rays as they need, and what views show of them for what it is worth.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "planner/hybrid.h"
#include "planner/tile_grid.h"
#include "tracer/render.h"
#include "tracer/scene.h"

namespace postlens {

/// Rays that a pixel gets at first, in two sets whose difference tells how noisy they are.
inline constexpr int first_rays = 32;

/// Squared errors are of encoded values, means of the channels.
struct PixelsAgain {
    std::span<const std::uint32_t> pixels;
    const TileGrid& grid;
    double tile_mse = 0;  ///< that a tile may be off by
    /// Expected of what the picture shows there.
    std::function<double(std::uint32_t k)> of_views;
    /// What a single ray may be off by and two sets do not know of: light that few of many meet.
    std::function<double(std::uint32_t k)> unseen_by_rays;
};

/// Traces pixels of the picture in `out` again. A tile where the rays leave more than a tenth of what it may
/// be off by gets more of them, up to 1024; the noise is its pixels' mean, as a pixel where both sets miss a
/// lamp does not know. What the picture shows counts beside the rays, each for what its expected error is
/// worth. Adds to `what`, `rays` and `retraced_share`. Same bits for any number of threads.
void trace_weighed(const Scene& scene, RenderSettings rays, const PixelsAgain& again, HybridResult& out);

}  // namespace postlens
