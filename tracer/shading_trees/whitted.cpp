#include "tracer/shading_trees/whitted.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "core/sample_hash.h"
#include "tracer/shading/averaged_shading.h"
#include "tracer/shading/radiance_bounds.h"
#include "tracer/shading/shading.h"
#include "tracer/shading_trees/lobe_means.h"
#include "tracer/shading_trees/ray_differentials.h"
#include "tracer/shading_trees/whitted_impl.h"

namespace postlens {
namespace {

using glm::dvec3;

}  // namespace

WhittedTracer::Impl::Workspace& WhittedTracer::Impl::workspace(std::span<const glm::dvec2> positions) const {
    thread_local Workspace w;
    w.shadows.resize(lights.size());
    w.shadow_rays.resize(lights.size());
    w.positions = positions;
    return w;
}

void WhittedTracer::Impl::start(Workspace& w, bool with_hidden) const {
    w.rays.count = w.nodes.count = w.differentials.count = w.bounces.count = 0;
    w.bent.clear();
    w.lobes.clear();
    w.lobe_targets.clear();
    w.extents.clear();
    w.extent_nodes.clear();
    w.batch.clear(false);
    w.eye_hits.resize(with_hidden ? w.positions.size() : 0);
    for (std::size_t i = 0; i < w.positions.size(); ++i) {
        const CameraRay eye = camera.ray(w.positions[i].x, w.positions[i].y);
        PathRay& r = w.rays.add();
        r.origin = eye.origin;
        r.direction = eye.direction;
        r.throughput = dvec3(1);
        r.length = 0;
        r.cos_axis = eye.cos_axis;
        r.sample = static_cast<std::uint32_t>(i);
        r.layer = r.parent = 0;
        r.root_depth = 0;
        r.path = NodePath();
        w.batch.add(eye.origin, eye.direction, std::numeric_limits<float>::infinity());
        if (w.eye_hits.empty()) continue;
        FirstHit& first = w.eye_hits[i];
        first.origin = eye.origin;
        first.direction = eye.direction;
        first.cos_axis = eye.cos_axis;
        first.at = w.positions[i];
        first.key = {};
    }
    w.chain_hits.clear();
    w.chain_rays.clear();
    w.chain_bounces.clear();
}

WhittedTracer::Impl::Node& WhittedTracer::Impl::add_node(const PathRay& ray, Workspace& w) const {
    Node& n = w.nodes.add();
    n.record.path = ray.path;
    n.record.layer = ray.layer;
    n.record.w_bend = 0;
    n.throughput = ray.throughput;
    n.noisy = dvec3(0);
    n.source = {};
    if (has_arrivals && ray.path.bits() != 0) {
        n.arrival = {glm::vec3(ray.origin), glm::vec3(ray.direction), std::numeric_limits<float>::infinity(),
                     static_cast<float>(largest(ray.throughput)), ray.parent};
    }
    n.sample = ray.sample;
    return n;
}

void WhittedTracer::Impl::miss(const PathRay& ray, Workspace& w) const {
    Node& n = add_node(ray, w);
    n.record.id = 0;
    n.record.z = std::numeric_limits<float>::infinity();
    const bool deeper = refocus && ray.path.bits() != 0;
    n.record.w = deeper ? refocus_matrix_at_infinity(w.differentials[ray.differentials]) : Mat2();
    n.radiance = rays.scene().background;
    if (deeper && measures_bends()) keep_bent(ray, nullptr, w);
}

void WhittedTracer::Impl::hit(const PathRay& ray, const SurfacePoint& s, const HitKey& key, Workspace& w,
                              RayCounts& counts) const {
    const Scene& scene = rays.scene();
    const Object& object = scene.objects[s.object];
    const Material& m = scene.materials[object.material];
    const Facing f = face(s, ray.direction);
    Node& n = add_node(ray, w);
    n.record.id = object.id;
    n.record.z = static_cast<float>((ray.length + s.t) * ray.cos_axis);
    if (ray.path.bits() != 0 && refocus) {
        RayDifferentials& d = w.differentials[ray.differentials];
        transfer(d, ray.direction, s.t, f.geometric_normal);
        n.record.w = refocus_matrix(d);
        if (measures_bends()) keep_bent(ray, &s, w);
    } else {
        n.record.w = Mat2::isotropic(1 / n.record.z);
    }
    if (settings.lit) {
        const dvec3 colour = surface_colour(m, s);
        n.radiance = own_radiance(scene, m, s, colour);
        n.arrival.length = static_cast<float>(s.t);
        n.source.texture = m.colour_texture ? m.colour_texture.get() : m.emission_texture.get();
        if (n.source.texture != nullptr) n.source.place = n.source.texture->place(s.object_position, s.uv);
        if (settings.parts != nullptr) n.source.part = settings.parts->part(s.object, key.primitive);
        light(ray, s, f, key, m, colour, w, counts);
    }
    spawn(ray, s, f, key, m, w, counts);
}

void WhittedTracer::Impl::light(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
                                const Material& m, const dvec3& colour, Workspace& w,
                                RayCounts& counts) const {
    const auto node = static_cast<std::uint32_t>(w.nodes.count - 1);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (lights[i].light->has_extent()) {
            const glm::dvec2& at = w.positions[ray.sample];
            const std::uint64_t seed =
                mix64(mix64(std::bit_cast<std::uint64_t>(at.x)) ^ std::bit_cast<std::uint64_t>(at.y));
            w.extents.push_back({&lights[i], &m, s, f, colour, ray.direction, ray.throughput, key,
                                 mix64(seed ^ (i << 40 | std::uint64_t{ray.layer} << 32 | ray.path.bits()))});
            w.extent_nodes.push_back(node);
            continue;
        }
        const Lit lit = lit_by(lights[i], lights[i].position, s, f, m, colour, ray.direction);
        if (lit.radiance == dvec3(0)) continue;
        if (!lit.casts_shadow) {
            w.nodes[node].radiance += lit.radiance;
            continue;
        }
        ++counts.shadow;
        Shadow& shadow = w.shadows[i].add();
        shadow.node = node;
        shadow.radiance = lit.radiance;
        w.shadow_rays[i].add(lit.origin, lit.segment, lit.reach, key);
    }
}

void WhittedTracer::Impl::child(const PathRay& parent, const SurfacePoint& s, const HitKey& key,
                                const dvec3& direction, const dvec3& off, const dvec3& throughput,
                                NodePath::Bounce bounce, Workspace& w) const {
    PathRay& r = w.next_rays.add();
    r.origin = s.position;
    r.direction = direction;
    r.throughput = throughput;
    r.length = parent.length + s.t;
    r.cos_axis = parent.cos_axis;
    r.sample = parent.sample;
    r.layer = parent.layer;
    r.parent = rays.scene().objects[s.object].id;
    r.differentials = static_cast<std::uint32_t>(w.next_differentials.count);
    r.path = parent.path.child(bounce);
    r.root_depth = parent.root_depth;
    w.next_batch.add(s.position + RayScene::offset(s.position) * off, direction,
                     std::numeric_limits<float>::infinity(), key);
}

void WhittedTracer::Impl::spawn(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
                                const Material& m, Workspace& w, RayCounts& counts) const {
    const int left = settings.max_depth - 1 - ray.path.depth();
    if (left < 1 || !(m.reflects() || m.transmission != dvec3(0))) return;
    const auto worth = [&](const dvec3& throughput) {
        return largest(throughput) > 0 &&
               largest(throughput) * bound[static_cast<std::size_t>(left)] >= settings.min_contribution;
    };
    const Continuation c = continuation(m, f, ray.direction);
    const dvec3 reflected = ray.throughput * c.reflected, transmitted = ray.throughput * c.transmitted;
    bool refracts = c.refracts && worth(transmitted);
    bool reflects = worth(reflected);
    const double distance = ray.length + s.t;
    if (reflects && lobe_is_wide(m.reflection_exponent, settings.lens_radius_m, distance)) {
        bool inwards = false;
        take_lobe(ray, s, key, mirrored_direction(c, f, ray.direction, inwards), f.geometric_normal,
                  m.reflection_exponent, c.reflected, NodePath::Bounce::reflected, w);
        reflects = false;
    }
    if (refracts && lobe_is_wide(m.transmission_exponent, settings.lens_radius_m, distance)) {
        take_lobe(ray, s, key, refracted_direction(c, f, ray.direction), -f.geometric_normal,
                  m.transmission_exponent, c.transmitted, NodePath::Bounce::transmitted, w);
        refracts = false;
    }
    if (!reflects && !refracts) return;

    const RayDifferentials* here = nullptr;
    glm::dmat3 shape_operator(0);
    if (refocus) {
        if (ray.path.bits() == 0) {
            w.at_eye = eye_differentials(camera, {ray.origin, ray.direction, ray.cos_axis});
            transfer(w.at_eye, ray.direction, s.t, f.geometric_normal);
            here = &w.at_eye;
        } else {
            here = &w.differentials[ray.differentials];
        }
        if (f.smooth) shape_operator = f.sign * rays.shape_operator(key, s);
    }
    Bounces bounces;
    if (measures_bends()) {
        if (ray.path.bits() != 0) bounces = w.bounces[ray.differentials];
        bounces.object[static_cast<std::size_t>(ray.path.depth())] = s.object;
        bounces.flat = bounces.flat && shape_operator == glm::dmat3(0);
    }
    if (reflects) {
        if (measures_bends()) w.next_bounces.add() = bounces;
        bool inwards = false;
        const dvec3 direction = mirrored_direction(c, f, ray.direction, inwards);
        ++counts.reflect;
        child(ray, s, key, direction, f.geometric_normal, reflected, NodePath::Bounce::reflected, w);
        if (refocus && inwards) {
            w.next_differentials.add() = reflect(*here, ray.direction, f.geometric_normal, glm::dmat3(0));
        } else if (refocus) {
            w.next_differentials.add() = reflect(*here, ray.direction, f.normal, shape_operator);
        }
    }
    if (refracts) {
        bounces.flat = false;  // behind glass, even if it is flat, W depends on the angle
        if (measures_bends()) w.next_bounces.add() = bounces;
        const dvec3 direction = refracted_direction(c, f, ray.direction);
        ++counts.refract;
        child(ray, s, key, direction, -f.geometric_normal, transmitted, NodePath::Bounce::transmitted, w);
        if (refocus)
            w.next_differentials.add() = refract(*here, ray.direction, f.normal, shape_operator, c.eta);
    }
}

void WhittedTracer::Impl::take_lobe(const PathRay& ray, const SurfacePoint& s, const HitKey& key,
                                    const dvec3& axis, const dvec3& side, double exponent, const dvec3& share,
                                    NodePath::Bounce bounce, Workspace& w) const {
    if (!lobe_means) return;
    w.lobes.push_back({s.object, ray.path.child(bounce), settings.max_depth - 1 - ray.path.depth(),
                       w.positions[ray.sample], s.position, axis, side, exponent, ray.throughput * share,
                       key});
    w.lobe_targets.push_back({static_cast<std::uint32_t>(w.nodes.count - 1), share, ray.throughput});
}

void WhittedTracer::Impl::resolve_shadows(Workspace& w) const {
    for (std::size_t i = 0; i < lights.size(); ++i) {
        RayBatch& batch = w.shadow_rays[i];
        if (batch.count == 0) continue;
        rays.occlude(batch);
        for (std::size_t k = 0; k < w.shadows[i].count; ++k) {
            const Shadow& shadow = w.shadows[i][k];
            Node& node = w.nodes[shadow.node];
            node.radiance += shadow.radiance * batch.transmittance[k];
            // A shadow is recorded only if it removes more than this radiance. Weaker shadows are not
            // visible, so quadtree cells are not subdivided for them.
            constexpr double little = 0.005;
            if (largest(shadow.radiance * (1.0 - dvec3(batch.transmittance[k])) * node.throughput) > little)
                node.source.shadows |= 1U << (i % 32U);
        }
    }
}

void WhittedTracer::Impl::begin_generation(Workspace& w) const {
    w.next_batch.clear(true);
    w.next_rays.count = w.next_differentials.count = w.next_bounces.count = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        w.shadows[i].count = 0;
        w.shadow_rays[i].clear(true);
    }
}

void WhittedTracer::Impl::end_generation(Workspace& w) const {
    resolve_shadows(w);
    std::swap(w.batch, w.next_batch);
    std::swap(w.rays, w.next_rays);
    std::swap(w.differentials, w.next_differentials);
    std::swap(w.bounces, w.next_bounces);
}

void WhittedTracer::Impl::generation(Workspace& w, RayCounts& counts) const {
    rays.intersect(w.batch, w.rays[0].path.bits() == 0);
    begin_generation(w);
    for (std::size_t i = 0; i < w.rays.count; ++i) {
        const PathRay& ray = w.rays[i];
        const HitKey key = w.batch.hit(i);
        if (!key.valid()) {
            miss(ray, w);
            continue;
        }
        const SurfacePoint surface =
            rays.surface(key, ray.origin, ray.direction, static_cast<double>(w.batch.t[i]));
        if (ray.path.bits() == 0) {
            ++counts.eye_hits;
            if (!w.eye_hits.empty()) {
                w.eye_hits[ray.sample].key = key;
                w.eye_hits[ray.sample].surface = surface;
            }
        } else if (hidden.lens != nullptr && !w.eye_hits.empty() && ray.layer == 0) {
            keep_chain(ray, surface, key, w);
        }
        hit(ray, surface, key, w, counts);
    }
    end_generation(w);
}

WhittedTracer::WhittedTracer(const RayScene& scene, const CameraModel& camera,
                             const WhittedSettings& settings, const HiddenLayers& hidden)
    : impl_(std::make_unique<Impl>(scene, camera, settings, hidden)) {
    impl_->settings.max_depth = std::clamp(settings.max_depth, 1, NodePath::max_bounces + 1);
    impl_->bound = radiance_bounds(scene.scene(), impl_->settings.max_depth);
    impl_->deeper_nodes = impl_->settings.max_depth > 1 && postlens::has_deeper_nodes(scene.scene());
    if (settings.lit) {
        for (const Light& l : scene.scene().lights) impl_->lights.push_back(place_light(l, scene.time_s()));
    }
    const AveragedShading averaged = averaged_shading(scene.scene());
    impl_->has_extents = settings.lit && averaged.lights > 0;
    if (settings.lit && impl_->deeper_nodes && averaged.materials > 0)
        impl_->lobe_means = std::make_unique<LobeMeans>(scene, impl_->settings);
    impl_->refocus = settings.refocus_matrices && impl_->deeper_nodes &&
                     camera.projection == Camera::Projection::perspective;
    const auto has_texture = [](const Material& m) { return m.colour_texture || m.emission_texture; };
    impl_->has_textures =
        std::any_of(scene.scene().materials.begin(), scene.scene().materials.end(), has_texture);
    impl_->has_sources = !impl_->lights.empty() || impl_->has_textures || impl_->settings.parts != nullptr;
    const auto is_bright = [](const Material& m) { return largest(m.emission) > 1; };
    impl_->has_arrivals = impl_->deeper_nodes && std::any_of(scene.scene().materials.begin(),
                                                             scene.scene().materials.end(), is_bright);
}

WhittedTracer::~WhittedTracer() = default;

bool WhittedTracer::has_deeper_nodes() const {
    return impl_->deeper_nodes;
}

bool WhittedTracer::has_textures() const {
    return impl_->has_textures;
}

bool WhittedTracer::has_parts() const {
    return impl_->settings.parts != nullptr;
}

bool WhittedTracer::measures_bends() const {
    return impl_->measures_bends();
}

void WhittedTracer::trace(std::span<const glm::dvec2> positions, TracedSamples& out, RayCounts& counts,
                          const std::function<SamplesAround(std::size_t)>& around) const {
    Impl::Workspace& w = impl_->workspace(positions);
    impl_->start(w, impl_->hidden.count > 0);
    counts.eye += positions.size();
    while (w.rays.count > 0) impl_->generation(w, counts);
    if (!w.eye_hits.empty()) impl_->trace_hidden(w, counts);
    if (around && !w.bent.empty()) impl_->take_bends_around(w, around);
    if (!w.bent.empty()) impl_->trace_bends(w, counts);
    if (!w.extents.empty()) impl_->average_extents(w, counts);
    if (!w.lobes.empty()) impl_->average_lobes(w, counts);  // needs the radiance of lights
    impl_->collect(w, out);
}

void WhittedTracer::trace_steady(std::span<const glm::dvec2> positions, TracedSamples& out,
                                 RayCounts& counts) const {
    Impl::Workspace& w = impl_->workspace(positions);
    impl_->start(w, false);
    counts.eye += positions.size();
    while (w.rays.count > 0) impl_->generation(w, counts);
    if (!w.extents.empty()) impl_->average_extents(w, counts);
    impl_->collect(w, out);
}

}  // namespace postlens
