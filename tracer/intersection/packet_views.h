// Access to Embree's ray packets, for the callbacks of user geometry.
#pragma once

#include <limits>

#include "tracer/intersection/ray_scene_geometry.h"

namespace postlens {

inline const RayContext& context_of(const RTCIntersectContext* context) {
    return *reinterpret_cast<const RayContext*>(context);
}

// Pointers into Embree's ray packet: one array of n values per field, in the order of RTCRay.
struct Rays {
    float *ox, *oy, *oz, *tnear, *dx, *dy, *dz, *time, *tfar;
    unsigned* id;
    Rays(RTCRayN* rays, unsigned n) {
        auto* f = reinterpret_cast<float*>(rays);
        ox = f, oy = f + n, oz = f + 2 * n, tnear = f + 3 * n;
        dx = f + 4 * n, dy = f + 5 * n, dz = f + 6 * n, time = f + 7 * n, tfar = f + 8 * n;
        id = reinterpret_cast<unsigned*>(f + 10 * n);
    }
};
/// Pointers into Embree's hit packet: the fields that are used, in the order of RTCHit.
struct Hits {
    unsigned *primitive, *geometry, *instance;
    Hits(RTCRayHitN* rayhit, unsigned n) {
        auto* u = reinterpret_cast<unsigned*>(RTCRayHitN_HitN(rayhit, n));
        primitive = u + 5 * n, geometry = u + 6 * n, instance = u + 7 * n;
    }
};

/// Decides which of two hits at the same distance counts. True if the new hit replaces the old one.
/// The decision does not depend on the order in which Embree finds the hits.
inline bool precedes(unsigned instance, unsigned geometry, unsigned primitive, unsigned old_instance,
                     unsigned old_geometry, unsigned old_primitive) {
    const bool in_geometry =
        (geometry < old_geometry) | ((geometry == old_geometry) & (primitive < old_primitive));
    return (old_geometry != RTC_INVALID_GEOMETRY_ID) &
           ((instance < old_instance) | ((instance == old_instance) & in_geometry));
}

inline bool leaves(const RayContext& context, unsigned ray_id, unsigned geometry, unsigned primitive) {
    if (context.sources == nullptr) return false;
    const HitKey& from = context.sources[ray_id];
    return from.geometry == geometry && from.primitive == primitive;
}

}  // namespace postlens
