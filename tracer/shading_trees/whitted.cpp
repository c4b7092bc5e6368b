#include "tracer/shading_trees/whitted.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <vector>

#include "core/sample_hash.h"
#include "tracer/shading/averaged_shading.h"
#include "tracer/shading/light_means.h"
#include "tracer/shading/radiance_bounds.h"
#include "tracer/shading/shading.h"
#include "tracer/shading_trees/lobe_means.h"
#include "tracer/shading_trees/ray_differentials.h"
#include "tracer/shading_trees/refocus_bend.h"

namespace postlens {
namespace {

using glm::dvec3;

// A ray of the current generation. `origin` is exact; the origin in the packet is offset from the surface.
struct PathRay {
    dvec3 origin{0}, direction{0}, throughput{0};
    double length = 0;    // of the path so far, m
    double cos_axis = 1;  // cosine of the angle between the eye ray and the optical axis
    std::uint32_t sample = 0;
    std::uint32_t differentials = 0;  // index; unused if W is not computed
    std::uint32_t layer = 0;
    std::uint32_t parent = 0;  // id of the object that reflected or transmitted the ray
    NodePath path;
    int root_depth = 0;  // depth of the first node of its layer
};

// A light's contribution to a node, before occlusion.
struct Shadow {
    std::uint32_t node = 0;
    dvec3 radiance{0};
};

struct Node {
    Record record;
    dvec3 radiance{0};
    dvec3 noisy{0};  // noisy part of the radiance (TracedSamples::noisy)
    dvec3 throughput{0};
    std::uint32_t sample = 0;
    ColourSource source;
};

// The node to which a lobe's mean is added, and the factor of the mean.
struct LobeTarget {
    std::uint32_t node = 0;
    dvec3 share{0};
};

// An array whose items are filled in place, field by field, and reused. Building items elsewhere and copying
// them took longer than the shading.
template <typename T>
struct Pool {
    std::vector<T> items;
    std::size_t count = 0;
    T& add() {
        if (count == items.size()) items.resize(std::max<std::size_t>(256, 2 * count));
        return items[count++];
    }
    [[nodiscard]] T& operator[](std::size_t i) { return items[i]; }
};

// Buffers of one thread, reused for every batch.
struct Workspace {
    std::span<const glm::dvec2> positions;
    Pool<PathRay> rays, next_rays;
    Pool<RayDifferentials> differentials, next_differentials;
    RayDifferentials at_eye;
    Pool<Node> nodes;
    std::vector<Pool<Shadow>> shadows;  // per light
    std::vector<RayBatch> shadow_rays;  // per light
    RayBatch batch, next_batch;
    std::vector<std::uint32_t> order;
    std::vector<FirstHit> eye_hits;  // empty if no hidden layers are recorded
    std::vector<HiddenHit> hidden;
    // Hits of reflected and refracted rays behind which a lens may see hidden surfaces, and the rays of these
    // hits.
    std::vector<FirstHit> chain_hits;
    std::vector<PathRay> chain_rays;
    std::vector<Bounces> chain_bounces;     // only if nonlinear W is measured
    std::vector<std::uint32_t> next_layer;  // of each sample
    // Used only if the nonlinear W of nodes is measured: the bounces of each ray by index of its
    // differentials, and the nodes to measure.
    Pool<Bounces> bounces, next_bounces;
    std::vector<BentNode> bent;
    std::vector<float> bends;
    // Means over lobes and over lights with an extent, of all generations.
    std::vector<LobeHit> lobes;
    std::vector<LobeTarget> lobe_targets;
    std::vector<dvec3> lobe_means;
    std::vector<ExtentLit> extents;
    std::vector<std::uint32_t> extent_nodes;
    RayBatch extent_rays;
};

// Converts nodes, which are ordered by generation, to records, ordered by sample, layer and path.
void collect(Workspace& w, bool noisy, bool sources, TracedSamples& out) {
    out.offsets.assign(w.positions.size() + 1, 0);
    for (std::size_t i = 0; i < w.nodes.count; ++i) ++out.offsets[w.nodes[i].sample + 1];
    for (std::size_t i = 1; i < out.offsets.size(); ++i) out.offsets[i] += out.offsets[i - 1];
    out.records.resize(w.nodes.count);
    out.noisy.resize(noisy ? w.nodes.count : 0);
    out.sources.resize(sources ? w.nodes.count : 0);
    std::vector<std::uint32_t>& next = w.order;
    next.assign(out.offsets.begin(), out.offsets.end() - 1);
    for (std::size_t i = 0; i < w.nodes.count; ++i) {
        Node& n = w.nodes[i];
        const dvec3 c = n.radiance * n.throughput;
        n.record.x = static_cast<float>(w.positions[n.sample].x);
        n.record.y = static_cast<float>(w.positions[n.sample].y);
        n.record.r = static_cast<float>(c.x);
        n.record.g = static_cast<float>(c.y);
        n.record.b = static_cast<float>(c.z);
        if (noisy) out.noisy[next[n.sample]] = glm::vec3(n.noisy * n.throughput);
        if (sources) out.sources[next[n.sample]] = n.source;
        out.records[next[n.sample]++] = n.record;
    }
    const auto before = [](const Record& a, const Record& b) {
        return a.layer != b.layer ? a.layer < b.layer : a.path.bits() < b.path.bits();
    };
    struct All {
        Record record;
        glm::vec3 noisy{0};
        ColourSource source;
    };
    std::vector<All> all;
    for (std::size_t i = 0; i < w.positions.size(); ++i) {
        const std::size_t begin = out.offsets[i], end = out.offsets[i + 1];
        const auto first = out.records.begin() + static_cast<std::ptrdiff_t>(begin),
                   last = out.records.begin() + static_cast<std::ptrdiff_t>(end);
        if (end - begin <= 2 || std::is_sorted(first, last, before)) continue;
        if (!noisy && !sources) {
            std::sort(first, last, before);
            continue;
        }
        all.clear();
        for (std::size_t k = begin; k < end; ++k) {
            all.push_back({out.records[k], noisy ? out.noisy[k] : glm::vec3(0),
                           sources ? out.sources[k] : ColourSource()});
        }
        std::sort(all.begin(), all.end(),
                  [&](const All& a, const All& b) { return before(a.record, b.record); });
        for (std::size_t k = begin; k < end; ++k) {
            out.records[k] = all[k - begin].record;
            if (noisy) out.noisy[k] = all[k - begin].noisy;
            if (sources) out.sources[k] = all[k - begin].source;
        }
    }
}

}  // namespace

struct WhittedTracer::Impl {
    Impl(const RayScene& s, const CameraModel& c, const WhittedSettings& w, const HiddenLayers& h)
        : rays(s), camera(c), settings(w), hidden(h) {}

    const RayScene& rays;
    const CameraModel& camera;
    WhittedSettings settings;
    HiddenLayers hidden;
    std::vector<PlacedLight> lights;
    std::unique_ptr<LobeMeans> lobe_means;  // null: no lobes are averaged
    bool has_extents = false;
    bool deeper_nodes = false;
    bool refocus = false;
    bool has_sources = false, has_textures = false;
    std::vector<double> bound;  // per number of nodes left: upper bound of a subtree's radiance

    void start(Workspace& w) const;
    void generation(Workspace& w, RayCounts& counts) const;
    void begin_generation(Workspace& w) const;
    void end_generation(Workspace& w) const;
    void keep_chain(const PathRay& ray, const SurfacePoint& s, const HitKey& key, Workspace& w) const;
    void trace_hidden(Workspace& w, RayCounts& counts) const;
    void trace_hidden_in_chains(Workspace& w, RayCounts& counts) const;
    void root(const FirstHit& first, const HiddenHit& h, PathRay ray, Workspace& w, RayCounts& counts) const;
    [[nodiscard]] static Node& add_node(const PathRay& ray, Workspace& w);
    void miss(const PathRay& ray, Workspace& w) const;
    void hit(const PathRay& ray, const SurfacePoint& s, const HitKey& key, Workspace& w,
             RayCounts& counts) const;
    void light(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
               const Material& m, const dvec3& colour, Workspace& w, RayCounts& counts) const;
    void spawn(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
               const Material& m, Workspace& w, RayCounts& counts) const;
    void child(const PathRay& parent, const SurfacePoint& s, const HitKey& key, const dvec3& direction,
               const dvec3& off, const dvec3& throughput, NodePath::Bounce bounce, Workspace& w) const;
    void resolve_shadows(Workspace& w) const;
    void take_lobe(const PathRay& ray, const SurfacePoint& s, const HitKey& key, const dvec3& axis,
                   const dvec3& side, double exponent, const dvec3& share, NodePath::Bounce bounce,
                   Workspace& w) const;
    void average_lobes(Workspace& w, RayCounts& counts) const;
    void average_extents(Workspace& w, RayCounts& counts) const;
    [[nodiscard]] bool noisy() const { return lobe_means || has_extents; }
    [[nodiscard]] bool measures_bends() const { return refocus && settings.bend_radius_m > 0; }
    void keep_bent(const PathRay& ray, const SurfacePoint* s, Workspace& w) const;
    void trace_bends(Workspace& w, RayCounts& counts) const;
    void take_bends_around(Workspace& w, const std::function<SamplesAround(std::size_t)>& around) const;
};

void WhittedTracer::Impl::start(Workspace& w) const {
    w.rays.count = w.nodes.count = w.differentials.count = w.bounces.count = 0;
    w.bent.clear();
    w.lobes.clear();
    w.lobe_targets.clear();
    w.extents.clear();
    w.extent_nodes.clear();
    w.batch.clear(false);
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
    }
    w.eye_hits.clear();
    if (hidden.count > 0) w.eye_hits.resize(w.positions.size());
    w.chain_hits.clear();
    w.chain_rays.clear();
    w.chain_bounces.clear();
}

// Adds a node and sets all of it but its depth, id, W and radiance.
Node& WhittedTracer::Impl::add_node(const PathRay& ray, Workspace& w) {
    Node& n = w.nodes.add();
    n.record.path = ray.path;
    n.record.layer = ray.layer;
    n.record.w_bend = 0;
    n.throughput = ray.throughput;
    n.noisy = dvec3(0);
    n.source = {};
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
    const dvec3 colour = surface_colour(m, s);
    n.radiance = own_radiance(scene, m, s, colour);
    n.source.texture = m.colour_texture ? m.colour_texture.get() : m.emission_texture.get();
    if (n.source.texture != nullptr) n.source.place = n.source.texture->place(s.object_position, s.uv);
    light(ray, s, f, key, m, colour, w, counts);
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
    if (left < 1) return;
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
        bounces.flat = false;  // behind glass, even flat glass, W depends on the angle
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
    w.lobe_targets.push_back({static_cast<std::uint32_t>(w.nodes.count - 1), share});
}

void WhittedTracer::Impl::average_lobes(Workspace& w, RayCounts& counts) const {
    lobe_means->average(w.lobes, w.lobe_means, counts);
    for (std::size_t i = 0; i < w.lobes.size(); ++i) {
        Node& n = w.nodes[w.lobe_targets[i].node];
        const dvec3 mean = w.lobe_targets[i].share * w.lobe_means[i];
        n.radiance += mean;
        n.noisy += mean;
    }
}

void WhittedTracer::Impl::average_extents(Workspace& w, RayCounts& counts) const {
    LightMeans(rays).average(w.extents, w.extent_rays, counts.shadow);
    for (std::size_t i = 0; i < w.extents.size(); ++i) {
        Node& n = w.nodes[w.extent_nodes[i]];
        n.radiance += w.extents[i].radiance;
        n.noisy += w.extents[i].radiance - w.extents[i].steady;
    }
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
            // Radiance of a light's contribution below which its shadow is not visible.
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
        } else if (hidden.lens != nullptr && ray.layer == 0) {
            keep_chain(ray, surface, key, w);
        }
        hit(ray, surface, key, w, counts);
    }
    end_generation(w);
}

// Stores the hit of a reflected or refracted ray if a lens may see hidden surfaces behind it. A hit where the
// ray leaves a glass object is not stored, because the transmitted ray sees the surfaces behind it.
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

// Adds a hidden surface as the root of its own shading tree, shaded as if nothing were in front of it.
void WhittedTracer::Impl::root(const FirstHit& first, const HiddenHit& h, PathRay ray, Workspace& w,
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
    for (std::size_t i = 0; i < w.positions.size(); ++i) {
        const CameraRay eye = camera.ray(w.positions[i].x, w.positions[i].y);
        w.eye_hits[i].origin = eye.origin;
        w.eye_hits[i].direction = eye.direction;
        w.eye_hits[i].cos_axis = eye.cos_axis;
        w.eye_hits[i].at = w.positions[i];
    }
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

// Traces hidden surfaces that are seen by reflection or refraction. Each surface becomes a separate layer of
// its sample, without a primary node.
void WhittedTracer::Impl::trace_hidden_in_chains(Workspace& w, RayCounts& counts) const {
    find_hidden_surfaces(rays, hidden, w.chain_hits, w.hidden, counts.hidden);
    std::sort(w.hidden.begin(), w.hidden.end(), [&](const HiddenHit& a, const HiddenHit& b) {
        const auto order = [&](const HiddenHit& h) {
            const PathRay& r = w.chain_rays[h.ray];
            return std::tuple(r.sample, r.path.bits(), h.layer);
        };
        return order(a) < order(b);
    });
    begin_generation(w);
    w.differentials.count = w.bounces.count = 0;
    for (const HiddenHit& h : w.hidden) {
        PathRay ray = w.chain_rays[h.ray];
        ray.layer = w.next_layer[ray.sample]++;
        root(w.chain_hits[h.ray], h, ray, w, counts);
    }
    end_generation(w);
    while (w.rays.count > 0) generation(w, counts);
}

// Stores a node whose matrix W may not be exact, so that its error is measured. `s` is null if the ray hit
// nothing.
void WhittedTracer::Impl::keep_bent(const PathRay& ray, const SurfacePoint* s, Workspace& w) const {
    const Bounces& bounces = w.bounces[ray.differentials];
    if (bounces.flat) return;
    const RayDifferentials& d = w.differentials[ray.differentials];
    const dvec3 eye = camera.ray(w.positions[ray.sample].x, w.positions[ray.sample].y).direction;
    BentNode n;
    n.node = static_cast<std::uint32_t>(w.nodes.count - 1);
    n.path = ray.path;
    n.bounces = bounces;
    n.hidden_bounce = ray.layer > 0 ? ray.root_depth : -1;
    n.at_infinity = s == nullptr;
    n.target = s == nullptr ? ray.direction : s->position;
    n.direction = ray.direction;
    n.tangent =
        glm::dvec2(glm::dot(eye, camera.right), glm::dot(eye, camera.down)) / glm::dot(eye, camera.forward);
    n.by_tangent =
        s == nullptr ? std::array{d.direction[0], d.direction[1]} : std::array{d.point[0], d.point[1]};
    n.w = w.nodes[n.node].record.w;
    w.bent.push_back(n);
}

void WhittedTracer::Impl::trace_bends(Workspace& w, RayCounts& counts) const {
    measure_bends(rays, camera, settings.bend_radius_m, w.bent, w.bends, counts.lens);
    for (std::size_t i = 0; i < w.bent.size(); ++i) w.nodes[w.bent[i].node].record.w_bend = w.bends[i];
}

// Takes the nonlinear W (`w_bend`) of nodes from samples nearby where possible. The nodes that must be
// measured stay in w.bent.
void WhittedTracer::Impl::take_bends_around(Workspace& w,
                                            const std::function<SamplesAround(std::size_t)>& around) const {
    const auto little = static_cast<float>(little_bend_px * camera.tangent_per_px /
                                           (settings.bend_radius_m * settings.bend_radius_m));
    std::erase_if(w.bent, [&](const BentNode& n) {
        Node& node = w.nodes[n.node];
        std::array<std::uint32_t, NodePath::max_bounces> ids{};
        const auto bounces = static_cast<std::size_t>(n.path.depth());
        for (std::size_t i = 0; i < bounces; ++i) ids[i] = rays.scene().objects[n.bounces.object[i]].id;
        const std::optional<float> bend = bend_around(
            around(node.sample),
            {n.path, node.record.id, n.hidden_bounce >= 0, std::span(ids).first(bounces)}, little);
        if (bend) node.record.w_bend = *bend;
        return bend.has_value();
    });
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
    impl_->has_sources = !impl_->lights.empty() || impl_->has_textures;
}

WhittedTracer::~WhittedTracer() = default;

bool WhittedTracer::has_deeper_nodes() const {
    return impl_->deeper_nodes;
}

bool WhittedTracer::has_textures() const {
    return impl_->has_textures;
}

bool WhittedTracer::measures_bends() const {
    return impl_->measures_bends();
}

void WhittedTracer::trace(std::span<const glm::dvec2> positions, TracedSamples& out, RayCounts& counts,
                          const std::function<SamplesAround(std::size_t)>& around) const {
    thread_local Workspace w;
    w.shadows.resize(impl_->lights.size());
    w.shadow_rays.resize(impl_->lights.size());
    w.positions = positions;
    impl_->start(w);
    counts.eye += w.positions.size();
    while (w.rays.count > 0) impl_->generation(w, counts);
    if (!w.eye_hits.empty()) impl_->trace_hidden(w, counts);
    if (around && !w.bent.empty()) impl_->take_bends_around(w, around);
    if (!w.bent.empty()) impl_->trace_bends(w, counts);
    if (!w.lobes.empty()) impl_->average_lobes(w, counts);
    if (!w.extents.empty()) impl_->average_extents(w, counts);
    collect(w, impl_->noisy(), impl_->has_sources, out);
}

}  // namespace postlens
