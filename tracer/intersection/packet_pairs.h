// Intersects eight or sixteen rays with one shape at a time.
#pragma once

#include "tracer/intersection/packet_views.h"

namespace postlens {

/// For each of up to 16 rays, the distances along the ray to its first crossing (`near`) and its last
/// crossing (`far`) with a shape. A missing crossing is infinite. The distances are bit-identical to those of
/// `crossings`, which intersects a single ray with the shape.
struct Pairs {
    alignas(64) float near[16], far[16];
};

/// Finds where a packet of n rays crosses the shape `item`, which can be crossed twice, and writes the two
/// distances of each ray to `out`. If a ray starts on the shape, the crossing at its origin is omitted.
/// `geometry` and `primitive` are Embree's ids of the shape. Returns false if n is not 8 or 16, or if the
/// kind of shape is not supported.
[[nodiscard]] bool packet_pairs(const AnalyticSet::Item& item, const Rays& rays, unsigned n,
                                const RayContext& context, unsigned geometry, unsigned primitive,
                                const int* valid, Pairs& out);

}  // namespace postlens
