// Where between the pixels the response of a point sample is placed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "records/quadtree.h"

namespace postlens {

/// A place relative to the whole coordinates at or before the sample, in 1/KernelKey::phase_steps px, and how
/// much of the sample goes there.
struct Phase {
    std::int32_t x, y;
    float weight;
};

/// At most four places.
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

/// Where the response of a sample is placed, and with what weights; they add up to the sample's weight.
///
/// A sample is one disc at its own position, to 1/16 px for small radii; for larger ones, of which there
/// would be too many kernels, a position in between is shared out to its neighbours on a coarser grid, which
/// keeps the centroid. Below 2 px of radius, a sample on the border of pixels that has more weight in one of
/// them than in another is split into its parts, each placed inside its pixel: so that the picture of a
/// vanishing CoC is the traced one.
[[nodiscard]] Phases phases_of(const PointSample& sample, double radius_px);

}  // namespace postlens
