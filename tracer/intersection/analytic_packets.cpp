// Embree's callbacks that intersect rays with analytic shapes (such as boxes and cones), at rest or moving.
// Also filters for hits on triangles. A packet is 1, 4, 8 or 16 rays, stored as a structure of arrays.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/multiversion.h"
#include "tracer/intersection/packet_pairs.h"

namespace postlens {
namespace {

Crossings<float> item_crossings(const AnalyticSet::Item& item, const Rays& rays, unsigned i) {
    const glm::vec3 o =
        item.linear * (glm::vec3(rays.ox[i], rays.oy[i], rays.oz[i]) - item.pivot) + item.shift;
    const glm::vec3 d = item.linear * glm::vec3(rays.dx[i], rays.dy[i], rays.dz[i]);
    return crossings<float>(item.shape, o, d);
}

// Removes one crossing from the list `c`, which holds the ray parameters t at which a ray crosses a shape.
// The ray starts on this shape, so the crossing nearest to t = 0 is the ray's own origin and not a hit.
template <typename T>
void drop_start(Crossings<T>& c) {
    int nearest = 0;
    for (int k = 1; k < c.count; ++k) {
        if (std::abs(c.t[k]) < std::abs(c.t[nearest])) nearest = k;
    }
    if (c.count > 0) {
        --c.count;
        c.t[nearest] = c.t[c.count];
        c.part[nearest] = c.part[c.count];
    }
}

// Intersects all valid rays of a packet (the group of rays that Embree passes to this function) with one
// primitive. The callback `of(rays, i)` must return the distances at which ray i crosses the primitive.
template <typename Found>
void intersect_item(const RTCIntersectFunctionNArguments* args, const Found& of) {
    const auto& context = context_of(args->context);
    Rays rays(RTCRayHitN_RayN(args->rayhit, args->N), args->N);
    Hits hits(args->rayhit, args->N);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        auto found = of(rays, i);
        if (leaves(context, rays.id[i], args->geomID, args->primID)) drop_start(found);
        for (int k = 0; k < found.count; ++k) {
            const auto t = static_cast<float>(found.t[k]);
            const bool nearer =
                t < rays.tfar[i] ||
                (t == rays.tfar[i] && precedes(args->context->instID[0], args->geomID, args->primID,
                                               hits.instance[i], hits.geometry[i], hits.primitive[i]));
            if (!(t > rays.tnear[i] && nearer)) continue;
            rays.tfar[i] = t;
            hits.primitive[i] = args->primID;
            hits.geometry[i] = args->geomID;
            hits.instance[i] = args->context->instID[0];
        }
    }
}

template <typename Found>
void occlude_item(const RTCOccludedFunctionNArguments* args, std::uint32_t object, const Found& of) {
    const auto& context = context_of(args->context);
    Rays rays(args->ray, args->N);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        auto found = of(rays, i);
        if (leaves(context, rays.id[i], args->geomID, args->primID)) drop_start(found);
        int crossed = 0;
        for (int k = 0; k < found.count; ++k) {
            const auto t = static_cast<float>(found.t[k]);
            if (t > rays.tnear[i] && t < rays.tfar[i]) ++crossed;
        }
        if (crossed > 0 && stops_light(context, object, rays.id[i], crossed)) {
            rays.tfar[i] = -std::numeric_limits<float>::infinity();
        }
    }
}

// For N rays, compares a shape's crossings with the nearest hit so far. A nearer crossing becomes the hit.
// Copies all inputs first, because the compiler cannot vectorise a loop whose pointers may alias.
template <unsigned N>
[[gnu::always_inline]] inline void take_nearest_of(const RTCIntersectFunctionNArguments* args,
                                                   const Rays& rays, const Hits& hits, const Pairs& pairs) {
    const unsigned primitive = args->primID, geometry = args->geomID, instance = args->context->instID[0];
    alignas(64) float from[N], to[N];
    alignas(64) unsigned old[3][N];
    alignas(64) int hit[N];
    std::memcpy(from, rays.tnear, sizeof from);
    std::memcpy(to, rays.tfar, sizeof to);
    std::memcpy(hit, args->valid, sizeof hit);
    std::memcpy(old[0], hits.primitive, sizeof old[0]);
    std::memcpy(old[1], hits.geometry, sizeof old[1]);
    std::memcpy(old[2], hits.instance, sizeof old[2]);
    for (unsigned i = 0; i < N; ++i) {
        const float near = pairs.near[i], far = pairs.far[i];
        const bool wins_tie = precedes(instance, geometry, primitive, old[2][i], old[1][i], old[0][i]);
        const bool first = (near > from[i]) & ((near < to[i]) | ((near == to[i]) & wins_tie)),
                   second = (far > from[i]) & ((far < to[i]) | ((far == to[i]) & wins_tie));
        const bool taken = (hit[i] != 0) & (first | second);
        to[i] = taken ? (first ? near : far) : to[i];
        old[0][i] = taken ? primitive : old[0][i];
        old[1][i] = taken ? geometry : old[1][i];
        old[2][i] = taken ? instance : old[2][i];
    }
    std::memcpy(rays.tfar, to, sizeof to);
    std::memcpy(hits.primitive, old[0], sizeof old[0]);
    std::memcpy(hits.geometry, old[1], sizeof old[1]);
    std::memcpy(hits.instance, old[2], sizeof old[2]);
}

POSTLENS_MULTIVERSION void take_nearest(const RTCIntersectFunctionNArguments* args, const Rays& rays,
                                        const Hits& hits, const Pairs& pairs) {
    if (args->N == 8) {
        take_nearest_of<8>(args, rays, hits, pairs);
    } else {
        take_nearest_of<16>(args, rays, hits, pairs);
    }
}

// Intersects a packet of 8 or 16 rays, Embree's usual sizes with AVX or later, with one shape.
// Returns false for other packet sizes, and for shapes that packet_pairs does not support.
bool intersect_packet(const RTCIntersectFunctionNArguments* args, const AnalyticSet::Item& item) {
    const Rays rays(RTCRayHitN_RayN(args->rayhit, args->N), args->N);
    Pairs pairs;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
    if (!packet_pairs(item, rays, args->N, context_of(args->context), args->geomID, args->primID, args->valid,
                      pairs))
        return false;
    take_nearest(args, rays, Hits(args->rayhit, args->N), pairs);
    return true;
}

bool occlude_packet(const RTCOccludedFunctionNArguments* args, const AnalyticSet::Item& item) {
    const Rays rays(args->ray, args->N);
    const auto& context = context_of(args->context);
    Pairs pairs;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
    if (!packet_pairs(item, rays, args->N, context, args->geomID, args->primID, args->valid, pairs))
        return false;
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        const int crossed = static_cast<int>(pairs.near[i] > rays.tnear[i] && pairs.near[i] < rays.tfar[i]) +
                            static_cast<int>(pairs.far[i] > rays.tnear[i] && pairs.far[i] < rays.tfar[i]);
        if (crossed > 0 && stops_light(context, item.object, rays.id[i], crossed)) {
            rays.tfar[i] = -std::numeric_limits<float>::infinity();
        }
    }
    return true;
}

void intersect_analytic(const RTCIntersectFunctionNArguments* args) {
    const auto& item = static_cast<const AnalyticSet*>(args->geometryUserPtr)->items[args->primID];
    if (intersect_packet(args, item)) return;
    intersect_item(args, [&](const Rays& rays, unsigned i) { return item_crossings(item, rays, i); });
}

void occlude_analytic(const RTCOccludedFunctionNArguments* args) {
    const auto& item = static_cast<const AnalyticSet*>(args->geometryUserPtr)->items[args->primID];
    if (occlude_packet(args, item)) return;
    occlude_item(args, item.object,
                 [&](const Rays& rays, unsigned i) { return item_crossings(item, rays, i); });
}

Crossings<double> moving_crossings(const MovingSet& set, unsigned primitive, const Rays& rays, unsigned i) {
    const MovingSet::Item& item = set.items[primitive];
    const auto [o, d] =
        set.local_ray(item, glm::dvec3(rays.ox[i], rays.oy[i], rays.oz[i]),
                      glm::dvec3(rays.dx[i], rays.dy[i], rays.dz[i]), static_cast<double>(rays.time[i]));
    return crossings<double>(item.shape, o, d);
}

void intersect_moving(const RTCIntersectFunctionNArguments* args) {
    const auto& set = *static_cast<const MovingSet*>(args->geometryUserPtr);
    intersect_item(
        args, [&](const Rays& rays, unsigned i) { return moving_crossings(set, args->primID, rays, i); });
}

void occlude_moving(const RTCOccludedFunctionNArguments* args) {
    const auto& set = *static_cast<const MovingSet*>(args->geometryUserPtr);
    occlude_item(args, set.items[args->primID].object,
                 [&](const Rays& rays, unsigned i) { return moving_crossings(set, args->primID, rays, i); });
}

// Returns a bounding box for Embree, slightly enlarged: due to float rounding, rays could miss a flat box.
// Coordinates are clamped, because Embree rejects bounds beyond about 1.8e18.
RTCBounds padded(glm::vec3 lo, glm::vec3 hi) {
    for (int c = 0; c < 3; ++c) {
        lo[c] = std::max(lo[c], -1e18F);
        hi[c] = std::min(hi[c], 1e18F);
    }
    const float grown = 1e-6F * std::max({std::abs(lo.x), std::abs(lo.y), std::abs(lo.z), std::abs(hi.x),
                                          std::abs(hi.y), std::abs(hi.z)});
    const float pad = grown > 1e11F ? 0.0F : grown;
    return {lo.x - pad, lo.y - pad, lo.z - pad, 0, hi.x + pad, hi.y + pad, hi.z + pad, 0};
}

void analytic_bounds(const RTCBoundsFunctionArguments* args) {
    const auto& set = *static_cast<const AnalyticSet*>(args->geometryUserPtr);
    *args->bounds_o = padded(set.lower[args->primID], set.upper[args->primID]);
}

void moving_bounds_at(const RTCBoundsFunctionArguments* args) {
    const auto& set = *static_cast<const MovingSet*>(args->geometryUserPtr);
    const std::size_t at = args->primID * static_cast<std::size_t>(set.steps + 1) + args->timeStep;
    *args->bounds_o = padded(set.lower[at], set.upper[at]);
}

}  // namespace

std::int64_t fixed_log(double transmission) {
    if (!(transmission > 0)) return log_opaque;
    return std::llround(std::clamp(-std::log2(transmission), -64.0, 64.0) * 4294967296.0);
}

double from_fixed_log(std::int64_t sum) {
    return sum >= log_opaque ? 0.0 : std::exp2(-static_cast<double>(sum) / 4294967296.0);
}

RTCGeometry analytic_geometry(RTCDevice device, AnalyticSet& set) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, static_cast<unsigned>(set.items.size()));
    rtcSetGeometryUserData(g, &set);
    rtcSetGeometryBoundsFunction(g, analytic_bounds, nullptr);
    rtcSetGeometryIntersectFunction(g, intersect_analytic);
    rtcSetGeometryOccludedFunction(g, occlude_analytic);
    return g;
}

RTCGeometry moving_geometry(RTCDevice device, MovingSet& set) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, static_cast<unsigned>(set.items.size()));
    rtcSetGeometryTimeStepCount(g, static_cast<unsigned>(set.steps + 1));
    rtcSetGeometryUserData(g, &set);
    rtcSetGeometryBoundsFunction(g, moving_bounds_at, nullptr);
    rtcSetGeometryIntersectFunction(g, intersect_moving);
    rtcSetGeometryOccludedFunction(g, occlude_moving);
    return g;
}

void filter_source(const RTCFilterFunctionNArguments* args) {
    const auto& context = context_of(args->context);
    if (context.sources == nullptr) return;
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        const HitKey& from = context.sources[RTCRayN_id(args->ray, args->N, i)];
        if (from.geometry == RTCHitN_geomID(args->hit, args->N, i) &&
            from.primitive == RTCHitN_primID(args->hit, args->N, i) &&
            from.instance == RTCHitN_instID(args->hit, args->N, i, 0)) {
            args->valid[i] = 0;
        }
    }
}

void filter_shadow(const RTCFilterFunctionNArguments* args) {
    filter_source(args);
    const auto& context = context_of(args->context);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        const unsigned instance = RTCHitN_instID(args->hit, args->N, i, 0);
        const unsigned top =
            instance == RTC_INVALID_GEOMETRY_ID ? RTCHitN_geomID(args->hit, args->N, i) : instance;
        const unsigned id = RTCRayN_id(args->ray, args->N, i);
        if (!stops_light(context, context.object_of_geometry[top], id, 1)) args->valid[i] = 0;
    }
}

}  // namespace postlens
