// Embree's callbacks that intersect rays with spheres.
// Embree passes N = 1, 4, 8 or 16 rays as a structure of arrays.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/multiversion.h"
#include "tracer/intersection/packet_views.h"

namespace postlens {
namespace {

struct SphereF {
    float x, y, z, r2;
};

/// Computes both crossings of N rays with a sphere. If a ray misses it, near > far.
/// Starts from the point of the ray nearest to the sphere's centre, to avoid cancellation.
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
        // A ray that starts inside the sphere hits the far crossing.
        const float first = near[i] > rays.tnear[i] ? near[i] : far[i];
        const bool hit =
            first > rays.tnear[i] && first <= rays.tfar[i] && near[i] <= far[i] && args->valid[i] != 0;
        t[i] = hit ? first : std::numeric_limits<float>::infinity();
    }
    if (context.sources != nullptr) {
        for (int i = 0; i < N; ++i) {
            if (args->valid[i] == 0) continue;
            const HitKey& from = context.sources[rays.id[i]];
            if (from.geometry != args->geomID || from.primitive != args->primID) continue;
            // Handles a ray that starts on this sphere. The ray crosses the sphere at two distances, `near`
            // and `far`. The one closer to 0 is the ray's own origin, and only the other one counts as a hit.
            const float other = std::abs(near[i]) < std::abs(far[i]) ? far[i] : near[i];
            const bool hit = near[i] <= far[i] && other > rays.tnear[i] && other <= rays.tfar[i];
            t[i] = hit ? other : std::numeric_limits<float>::infinity();
        }
    }
    const unsigned primitive = args->primID, geometry = args->geomID, instance = args->context->instID[0];
    for (int i = 0; i < N; ++i) {
        const bool wins_tie =
            precedes(instance, geometry, primitive, hits.instance[i], hits.geometry[i], hits.primitive[i]);
        const bool hit = (t[i] < rays.tfar[i]) | ((t[i] == rays.tfar[i]) & wins_tie);
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

// Functions that Embree calls to intersect 8 or 16 rays with a sphere, or to test whether it blocks them. The
// compiler makes one version of each function for each instruction set. The templates that they call are
// inlined, because otherwise these would be compiled for only one instruction set.
POSTLENS_MULTIVERSION void intersect_spheres_8(const RTCIntersectFunctionNArguments* a) {
    intersect_spheres<8>(a);
}
POSTLENS_MULTIVERSION void intersect_spheres_16(const RTCIntersectFunctionNArguments* a) {
    intersect_spheres<16>(a);
}
POSTLENS_MULTIVERSION void occlude_spheres_8(const RTCOccludedFunctionNArguments* a) {
    occlude_spheres<8>(a);
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
            intersect_spheres_8(args);
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
            occlude_spheres_8(args);
            break;
        default:
            occlude_spheres_16(args);
            break;
    }
}

void sphere_bounds(const RTCBoundsFunctionArguments* args) {
    const auto& set = *static_cast<const SphereSet*>(args->geometryUserPtr);
    const glm::vec3 c = set.centre[args->primID];
    // Sets the bounding box that Embree uses for the sphere. It is slightly larger than the sphere, because
    // rounding may place a hit just outside the sphere.
    const float grown = set.radius[args->primID] * 1.000001F +
                        4e-7F * std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
    *args->bounds_o = {c.x - grown, c.y - grown, c.z - grown, 0, c.x + grown, c.y + grown, c.z + grown, 0};
}

}  // namespace

RTCGeometry sphere_geometry(RTCDevice device, SphereSet& set) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, static_cast<unsigned>(set.radius.size()));
    rtcSetGeometryUserData(g, &set);
    rtcSetGeometryBoundsFunction(g, sphere_bounds, nullptr);
    rtcSetGeometryIntersectFunction(g, intersect_spheres_n);
    rtcSetGeometryOccludedFunction(g, occlude_spheres_n);
    return g;
}

}  // namespace postlens
