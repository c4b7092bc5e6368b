// Subpixel positions where the blur kernel of a sample is placed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "records/quadtree.h"

namespace postlens {

/// A subpixel position at which a sample's blur kernel is added to the image, and the weight with which it is
/// added. x and y are the distances of the kernel's centre from the upper left corner of a pixel. Their unit
/// is 1/16 px (1 / KernelKey::phase_steps).
struct Phase {
    std::int32_t x, y;
    float weight;
};

/// The subpixel positions, at most four, at which a sample's blur kernel is added to the image. Together they
/// approximate the area of the sample.
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

/// Returns one or more subpixel positions for the centre of a sample's blur kernel. The sample's light is
/// divided among them: their weights add up to the weight of the sample.
[[nodiscard]] Phases phases_of(const PointSample& sample, double radius_px);

}  // namespace postlens
