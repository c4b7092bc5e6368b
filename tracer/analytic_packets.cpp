// Embree's callbacks for analytic shapes. Rays come as structures of arrays of N = 1, 4, 8 or 16.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/multiversion.h"
#include "tracer/ray_scene_geometry.h"

namespace postlens {
namespace {

const RayContext& context_of(const RTCIntersectContext* context) {
    return *reinterpret_cast<const RayContext*>(context);
}

// Views of Embree's ray and hit arrays: the field order of RTCRay and RTCHit, each field N wide.
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
struct Hits {
    unsigned *primitive, *geometry, *instance;
    Hits(RTCRayHitN* rayhit, unsigned n) {
        auto* u = reinterpret_cast<unsigned*>(RTCRayHitN_HitN(rayhit, n));
        primitive = u + 5 * n, geometry = u + 6 * n, instance = u + 7 * n;
    }
};

struct SphereF {
    float x, y, z, r2;
};

/// Both crossings of N rays with a sphere, measured from the point of each ray nearest to the centre, where
/// nothing large cancels. near > far where the sphere is missed.
template <int N>
[[gnu::always_inline]] inline void sphere_packet(const Rays& rays, const SphereF& s, float* near,
                                                 float* far) {
    for (int i = 0; i < N; ++i) {
        const float ox = rays.ox[i] - s.x, oy = rays.oy[i] - s.y, oz = rays.oz[i] - s.z;
        const float dx = rays.dx[i], dy = rays.dy[i], dz = rays.dz[i];
        const float inverse_dd = 1.0F / (dx * dx + dy * dy + dz * dz);
        const float tc = -(ox * dx + oy * dy + oz * dz) * inverse_dd;
        const float lx = ox + tc * dx, ly = oy + tc * dy, lz = oz + tc * dz;
        const float h2 = (s.r2 - (lx * lx + ly * ly + lz * lz)) * inverse_dd;
        const float h = std::sqrt(h2 > 0 ? h2 : 0.0F);
        near[i] = h2 >= 0 ? tc - h : std::numeric_limits<float>::infinity();
        far[i] = h2 >= 0 ? tc + h : -std::numeric_limits<float>::infinity();
    }
}

template <int N>
[[gnu::always_inline]] inline void intersect_spheres(const RTCIntersectFunctionNArguments* args) {
    const auto& set = *static_cast<const SphereSet*>(args->geometryUserPtr);
    const auto& context = context_of(args->context);
    Rays rays(RTCRayHitN_RayN(args->rayhit, N), N);
    Hits hits(args->rayhit, N);
    const glm::vec3 c = set.centre[args->primID];
    const float r = set.radius[args->primID];
    alignas(64) float near[N], far[N], t[N];
    sphere_packet<N>(rays, {c.x, c.y, c.z, r * r}, near, far);
    for (int i = 0; i < N; ++i) {
        // The far crossing counts for rays that start inside.
        const float first = near[i] > rays.tnear[i] ? near[i] : far[i];
        const bool hit =
            first > rays.tnear[i] && first < rays.tfar[i] && near[i] <= far[i] && args->valid[i] != 0;
        t[i] = hit ? first : std::numeric_limits<float>::infinity();
    }
    if (context.sources != nullptr) {
        for (int i = 0; i < N; ++i) {
            if (args->valid[i] == 0) continue;
            const HitKey& from = context.sources[rays.id[i]];
            if (from.geometry != args->geomID || from.primitive != args->primID) continue;
            // Leaving this very sphere: of the two crossings one is the start, the other may be the exit.
            const float other = std::abs(near[i]) < std::abs(far[i]) ? far[i] : near[i];
            const bool hit = near[i] <= far[i] && other > rays.tnear[i] && other < rays.tfar[i];
            t[i] = hit ? other : std::numeric_limits<float>::infinity();
        }
    }
    const unsigned primitive = args->primID, geometry = args->geomID, instance = args->context->instID[0];
    for (int i = 0; i < N; ++i) {
        const bool hit = t[i] < rays.tfar[i];
        rays.tfar[i] = hit ? t[i] : rays.tfar[i];
        hits.primitive[i] = hit ? primitive : hits.primitive[i];
        hits.geometry[i] = hit ? geometry : hits.geometry[i];
        hits.instance[i] = hit ? instance : hits.instance[i];
    }
}

template <int N>
[[gnu::always_inline]] inline void occlude_spheres(const RTCOccludedFunctionNArguments* args) {
    const auto& set = *static_cast<const SphereSet*>(args->geometryUserPtr);
    const auto& context = context_of(args->context);
    Rays rays(args->ray, N);
    const glm::vec3 c = set.centre[args->primID];
    const float r = set.radius[args->primID];
    alignas(64) float near[N], far[N];
    alignas(64) int crossed[N];
    sphere_packet<N>(rays, {c.x, c.y, c.z, r * r}, near, far);
    int any = 0;
    for (int i = 0; i < N; ++i) {
        const int n = static_cast<int>(near[i] > rays.tnear[i] && near[i] < rays.tfar[i]) +
                      static_cast<int>(far[i] > rays.tnear[i] && far[i] < rays.tfar[i]);
        crossed[i] = args->valid[i] != 0 && near[i] <= far[i] ? n : 0;
        any |= crossed[i];
    }
    if (any == 0) return;
    const std::uint32_t object = set.object[args->primID];
    for (int i = 0; i < N; ++i) {
        if (crossed[i] == 0) continue;
        if (context.sources != nullptr) {
            const HitKey& from = context.sources[rays.id[i]];
            if (from.geometry == args->geomID && from.primitive == args->primID) {
                const float other = std::abs(near[i]) < std::abs(far[i]) ? far[i] : near[i];
                crossed[i] = other > rays.tnear[i] && other < rays.tfar[i] ? 1 : 0;
                if (crossed[i] == 0) continue;
            }
        }
        if (stops_light(context, object, rays.id[i], crossed[i]))
            rays.tfar[i] = -std::numeric_limits<float>::infinity();
    }
}

// Everything above is inlined here, so that it is compiled for each instruction set.
POSTLENS_MULTIVERSION void intersect_spheres_16(const RTCIntersectFunctionNArguments* a) {
    intersect_spheres<16>(a);
}
POSTLENS_MULTIVERSION void occlude_spheres_16(const RTCOccludedFunctionNArguments* a) {
    occlude_spheres<16>(a);
}

void intersect_spheres_n(const RTCIntersectFunctionNArguments* args) {
    switch (args->N) {
        case 1:
            intersect_spheres<1>(args);
            break;
        case 4:
            intersect_spheres<4>(args);
            break;
        case 8:
            intersect_spheres<8>(args);
            break;
        default:
            intersect_spheres_16(args);
            break;
    }
}

void occlude_spheres_n(const RTCOccludedFunctionNArguments* args) {
    switch (args->N) {
        case 1:
            occlude_spheres<1>(args);
            break;
        case 4:
            occlude_spheres<4>(args);
            break;
        case 8:
            occlude_spheres<8>(args);
            break;
        default:
            occlude_spheres_16(args);
            break;
    }
}

void sphere_bounds(const RTCBoundsFunctionArguments* args) {
    const auto& set = *static_cast<const SphereSet*>(args->geometryUserPtr);
    const glm::vec3 c = set.centre[args->primID];
    // A little wider than exact: the packet's own rounding must not reach outside its box.
    const float grown = set.radius[args->primID] * 1.000001F +
                        4e-7F * std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
    *args->bounds_o = {c.x - grown, c.y - grown, c.z - grown, 0, c.x + grown, c.y + grown, c.z + grown, 0};
}

Crossings<float> item_crossings(const AnalyticSet::Item& item, const Rays& rays, unsigned i) {
    const glm::vec3 o =
        item.linear * (glm::vec3(rays.ox[i], rays.oy[i], rays.oz[i]) - item.pivot) + item.shift;
    const glm::vec3 d = item.linear * glm::vec3(rays.dx[i], rays.dy[i], rays.dz[i]);
    return crossings<float>(item.shape, o, d);
}

// Leaving this very shape: the crossing nearest to the start is the start itself.
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

bool leaves(const RayContext& context, unsigned ray_id, unsigned geometry, unsigned primitive) {
    if (context.sources == nullptr) return false;
    const HitKey& from = context.sources[ray_id];
    return from.geometry == geometry && from.primitive == primitive;
}

// One item for every ray of a packet; `of(i)` are the crossings of ray i.
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
            if (!(t > rays.tnear[i] && t < rays.tfar[i])) continue;
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

void intersect_analytic(const RTCIntersectFunctionNArguments* args) {
    const auto& item = static_cast<const AnalyticSet*>(args->geometryUserPtr)->items[args->primID];
    intersect_item(args, [&](const Rays& rays, unsigned i) { return item_crossings(item, rays, i); });
}

void occlude_analytic(const RTCOccludedFunctionNArguments* args) {
    const auto& item = static_cast<const AnalyticSet*>(args->geometryUserPtr)->items[args->primID];
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

// Embree takes no bounds beyond about 1.8e18; a flat box needs a little thickness for float rounding.
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

RTCGeometry sphere_geometry(RTCDevice device, SphereSet& set) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, static_cast<unsigned>(set.radius.size()));
    rtcSetGeometryUserData(g, &set);
    rtcSetGeometryBoundsFunction(g, sphere_bounds, nullptr);
    rtcSetGeometryIntersectFunction(g, intersect_spheres_n);
    rtcSetGeometryOccludedFunction(g, occlude_spheres_n);
    return g;
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
