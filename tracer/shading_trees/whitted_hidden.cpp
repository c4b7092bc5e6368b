// Shades the surfaces that lie hidden behind the first hit of a ray. The ray may be an eye ray or a reflected
// or refracted ray. A hidden surface may itself reflect or transmit light. So rays are traced from it, and it
// becomes the root of its own shading tree, which contains this surface and all surfaces that are seen in it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <tuple>

#include "tracer/shading_trees/hidden_surfaces.h"
#include "tracer/shading_trees/lens_reach.h"
#include "tracer/shading_trees/whitted_impl.h"

namespace postlens {
namespace {

using glm::dvec3;

}  // namespace

void WhittedTracer::Impl::keep_chain(const PathRay& ray, const SurfacePoint& s, const HitKey& key,
                                     Workspace& w) const {
    if (!refocus || ray.path.depth() > LensReach::most_bounces) return;
    const bool own_way_out =
        rays.scene().objects[s.object].id == ray.parent && glm::dot(ray.direction, s.geometric_normal) >= 0;
    if (own_way_out) return;
    FirstHit first{ray.origin, ray.direction, ray.cos_axis, w.positions[ray.sample],           key,
                   s,          ray.path,      ray.parent,   w.differentials[ray.differentials]};
    RayDifferentials there = first.differentials;
    transfer(there, ray.direction, s.t, s.geometric_normal);
    const double inverse_depth = LensReach::inverse_depth(refocus_matrix(there));
    if (!hidden.lens->may_see_past(
            {first.at, first.path, first.parent, inverse_depth, inverse_depth, first.inverse_depth_limit()}))
        return;
    w.chain_hits.push_back(first);
    w.chain_rays.push_back(ray);
    if (measures_bends()) w.chain_bounces.push_back(w.bounces[ray.differentials]);
}

void WhittedTracer::Impl::root(const FirstHit& first, const HiddenHit& h, PathRay& ray, Workspace& w,
                               RayCounts& counts) const {
    if (ray.path.bits() != 0) {
        ray.differentials = static_cast<std::uint32_t>(w.differentials.count);
        w.differentials.add() = first.differentials;
        if (measures_bends()) w.bounces.add() = w.chain_bounces[h.ray];
    }
    ray.root_depth = ray.path.depth();
    if (h.key.valid()) {
        hit(ray, h.surface, h.key, w, counts);
    } else {
        miss(ray, w);
    }
}

void WhittedTracer::Impl::trace_hidden(Workspace& w, RayCounts& counts) const {
    find_hidden_surfaces(rays, hidden, w.eye_hits, w.hidden, counts.hidden);
    begin_generation(w);
    w.next_layer.assign(w.positions.size(), 1);
    for (const HiddenHit& h : w.hidden) {
        const FirstHit& eye = w.eye_hits[h.ray];
        w.next_layer[h.ray] = h.layer + 1;
        PathRay ray;
        ray.origin = eye.origin;
        ray.direction = eye.direction;
        ray.throughput = dvec3(1);
        ray.cos_axis = eye.cos_axis;
        ray.sample = h.ray;
        ray.layer = h.layer;
        root(eye, h, ray, w, counts);
    }
    end_generation(w);
    while (w.rays.count > 0) generation(w, counts);
    if (!w.chain_hits.empty()) trace_hidden_in_chains(w, counts);
}

void WhittedTracer::Impl::trace_hidden_in_chains(Workspace& w, RayCounts& counts) const {
    find_hidden_surfaces(rays, hidden, w.chain_hits, w.hidden, counts.hidden);
    w.order.resize(w.hidden.size());
    std::iota(w.order.begin(), w.order.end(), 0U);
    std::sort(w.order.begin(), w.order.end(), [&](std::uint32_t a, std::uint32_t b) {
        const auto order = [&](const HiddenHit& h) {
            const PathRay& r = w.chain_rays[h.ray];
            return std::tuple(r.sample, r.path.bits(), h.layer);
        };
        return order(w.hidden[a]) < order(w.hidden[b]);
    });
    begin_generation(w);
    w.differentials.count = w.bounces.count = 0;
    for (const std::uint32_t i : w.order) {
        const HiddenHit& h = w.hidden[i];
        PathRay ray = w.chain_rays[h.ray];
        ray.layer = w.next_layer[ray.sample]++;
        root(w.chain_hits[h.ray], h, ray, w, counts);
    }
    end_generation(w);
    while (w.rays.count > 0) generation(w, counts);
}

}  // namespace postlens
