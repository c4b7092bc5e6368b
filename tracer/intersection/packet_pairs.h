// Intersects eight or sixteen rays with one shape at a time.
#pragma once

#include "tracer/intersection/packet_views.h"

namespace postlens {

/// For each ray, the distances of its first and its last crossing of a shape. A missing crossing is infinite.
/// The results are bit-identical to those of the scalar code, because the operations have the same order.
struct Pairs {
    alignas(64) float near[16], far[16];
};

/// Computes the crossings of n = 8 or 16 rays with `item`. If a ray starts on this shape, the crossing at its
/// origin is omitted. `geometry` and `primitive` identify the shape. Returns false for any other n, and for
/// shapes without a packet version.
[[nodiscard]] bool packet_pairs(const AnalyticSet::Item& item, const Rays& rays, unsigned n,
                                const RayContext& context, unsigned geometry, unsigned primitive,
                                const int* valid, Pairs& out);

}  // namespace postlens
