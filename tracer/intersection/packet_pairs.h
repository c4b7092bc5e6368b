// Intersects eight or sixteen rays with one shape at a time.
#pragma once

#include "tracer/intersection/packet_views.h"

namespace postlens {

/// The distances of the first and last crossing of a shape, per ray. A missing crossing is infinite.
/// The operations are in the order of the scalar code, so results are bit-identical.
struct Pairs {
    alignas(64) float near[16], far[16];
};

/// Computes the crossings of n = 8 or 16 rays with `item`, which `geometry` and `primitive` identify.
/// If a ray starts on `item`, the crossing at its origin is omitted. Returns false for other n or shapes.
[[nodiscard]] bool packet_pairs(const AnalyticSet::Item& item, const Rays& rays, unsigned n,
                                const RayContext& context, unsigned geometry, unsigned primitive,
                                const int* valid, Pairs& out);

}  // namespace postlens
