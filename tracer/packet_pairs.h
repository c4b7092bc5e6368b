// Eight or sixteen rays against one shape at a time.
#pragma once

#include "tracer/packet_views.h"

namespace postlens {

/// Crossings of the rays with a shape, the nearer first; infinity where there is none. What the scalar code
/// does, lane by lane, in the same order.
struct Pairs {
    alignas(64) float near[16], far[16];
};

/// Of the rays of a packet of n = 8 or 16 with an item; the crossing that a ray starts from is left out
/// (`geometry` and `primitive` say which surface this is). False for another n.
[[nodiscard]] bool packet_pairs(const AnalyticSet::Item& item, const Rays& rays, unsigned n,
                                const RayContext& context, unsigned geometry, unsigned primitive,
                                const int* valid, Pairs& out);

}  // namespace postlens
