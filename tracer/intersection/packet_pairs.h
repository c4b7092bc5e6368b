// Intersects eight or sixteen rays with one shape at a time.
#pragma once

#include "tracer/intersection/packet_views.h"

namespace postlens {

/// Per ray, the distances of its first and last crossing with a shape. A missing crossing is infinite.
/// The distances are bit-identical to those of the scalar code.
struct Pairs {
    alignas(64) float near[16], far[16];
};

/// Finds where n = 8 or 16 rays cross the shape `item`. Returns false for other n or unsupported shapes.
/// If a ray starts on the shape, the crossing at its origin is omitted.
/// `geometry` and `primitive` are Embree's ids of the shape.
[[nodiscard]] bool packet_pairs(const AnalyticSet::Item& item, const Rays& rays, unsigned n,
                                const RayContext& context, unsigned geometry, unsigned primitive,
                                const int* valid, Pairs& out);

}  // namespace postlens
