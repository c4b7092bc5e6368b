// Subpixel positions at which the impulse response of a point sample is placed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "records/quadtree.h"

namespace postlens {

/// A position relative to the integer coordinates at or before the sample, unit 1/KernelKey::phase_steps px,
/// and the weight of the sample there.
struct Phase {
    std::int32_t x, y;
    float weight;
};

/// The subpixel positions over which a sample's impulse response is distributed: at most four.
struct Phases {
    std::array<Phase, 4> items{};
    std::size_t count = 0;

    void add(std::int32_t x, std::int32_t y, float weight) {
        for (std::size_t i = 0; i < count; ++i) {
            if (items[i].x == x && items[i].y == y) {
                items[i].weight += weight;
                return;
            }
        }
        items[count++] = {x, y, weight};
    }
};

/// Positions and weights at which the response of a sample is placed; the weights add up to the sample's
/// weight.
///
/// A small disc is placed at the sample's position, quantised to 1/16 px. Larger discs would need too many
/// kernels, so they are distributed over the nearest positions of a coarser grid, which preserves the
/// centroid. Below a radius of 2 px, a sample on the border of pixels that has different weights in them is
/// divided, and each part is placed inside its pixel, so that the image for a CoC of 0 is the pinhole image.
[[nodiscard]] Phases phases_of(const PointSample& sample, double radius_px);

}  // namespace postlens
