// The implementation of WhittedTracer. Only the files whitted*.cpp include this header.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "tracer/shading/light_means.h"
#include "tracer/shading/shading.h"
#include "tracer/shading_trees/lobe_means.h"
#include "tracer/shading_trees/ray_differentials.h"
#include "tracer/shading_trees/refocus_bend.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {

struct WhittedTracer::Impl {
    // An eye ray, or a ray into which it continues by reflection or refraction.
    // `origin` lies exactly on the surface, but the ray that is passed to Embree starts slightly off it.
    struct PathRay {
        glm::dvec3 origin{0}, direction{0}, throughput{0};
        double length = 0;    // of the path so far, m
        double cos_axis = 1;  // cosine of the angle between the eye ray and the optical axis
        std::uint32_t sample = 0;
        std::uint32_t differentials = 0;  // index; unused if W is not computed
        std::uint32_t layer = 0;
        std::uint32_t parent = 0;  // id of the object that reflected or transmitted the ray
        NodePath path;
        int root_depth = 0;  // depth of the first node of its layer
    };

    // A light's contribution to the radiance of surface point number `node`, stored until its shadow ray is
    // traced.
    struct Shadow {
        std::uint32_t node = 0;
        glm::dvec3 radiance{0};
    };

    struct Node {
        Record record;
        glm::dvec3 radiance{0};
        glm::dvec3 noisy{0};  // noisy part of the radiance (TracedSamples::noisy)
        glm::dvec3 throughput{0};
        std::uint32_t sample = 0;
        ColourSource source;
        Arrival arrival;
    };

    struct LobeTarget {
        std::uint32_t node = 0;
        glm::dvec3 share{0}, throughput{1};
    };

    // An array whose items are reused for the next batch. add() returns a new item, and the caller sets its
    // members in place. Filling in a separate item and copying it took longer than the shading itself.
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
        std::vector<FirstHit> chain_hits;
        std::vector<PathRay> chain_rays;
        std::vector<Bounces> chain_bounces;     // only if `w_bend` is measured
        std::vector<std::uint32_t> next_layer;  // of each sample
        Pool<Bounces> bounces, next_bounces;
        std::vector<BentNode> bent;
        std::vector<float> bends;
        // Lists of surface points whose radiance is computed after tracing, as a mean over several rays.
        // `lobes` contains points of glossy surfaces, which send random rays into a cone of directions.
        // `extents` contains points that area lights illuminate; they send shadow rays to several points of
        // the light.
        std::vector<LobeHit> lobes;
        std::vector<LobeTarget> lobe_targets;
        std::vector<glm::dvec3> lobe_means;
        std::vector<ExtentLit> extents;
        std::vector<std::uint32_t> extent_nodes;
        RayBatch extent_rays;
    };

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
    bool has_sources = false, has_textures = false, has_arrivals = false;
    std::vector<double> bound;  // for each number of nodes left, an upper bound of the radiance of a subtree

    [[nodiscard]] Workspace& workspace(std::span<const glm::dvec2> positions) const;
    // These functions trace the rays of a batch, one generation after another. A generation contains all rays
    // with the same number of bounces. start() makes the first generation, the eye rays. Each call of
    // generation() traces the current generation, and makes the next one from the reflections and refractions
    // at its hits. If `with_hidden` is true, the first hits are stored, to search for hidden surfaces behind
    // them later.
    void start(Workspace& w, bool with_hidden) const;
    void generation(Workspace& w, RayCounts& counts) const;
    void begin_generation(Workspace& w) const;
    void end_generation(Workspace& w) const;
    // Stores the surface hit of a reflected or refracted ray, because a lens point may see other surfaces
    // past this one. These hidden surfaces are searched for later, on the same ray. The hit is not stored if
    // certainly no lens point sees past it. It is also not stored if the ray leaves a glass object there: the
    // refracted ray continues behind the glass anyway and finds those surfaces.
    void keep_chain(const PathRay& ray, const SurfacePoint& s, const HitKey& key, Workspace& w) const;
    void trace_hidden(Workspace& w, RayCounts& counts) const;
    // Finds the surfaces that lie hidden behind others in a mirror or in glass, and that other lens points
    // see. Each of them becomes a new layer of the sample, i.e. a group of records beside the visible ones.
    // The mirror or glass gets no record in the new layer, because the visible layer contains it already.
    void trace_hidden_in_chains(Workspace& w, RayCounts& counts) const;
    // Shades a hidden surface, which the ray `first` hits at `h` behind other surfaces. Those are ignored,
    // because the surface is recorded for lens points or instants at which nothing hides it. The surface
    // becomes the root of a new shading tree, i.e. of the surfaces that are seen in it by reflection or
    // refraction.
    void root(const FirstHit& first, const HiddenHit& h, PathRay& ray, Workspace& w, RayCounts& counts) const;
    [[nodiscard]] Node& add_node(const PathRay& ray, Workspace& w) const;
    void miss(const PathRay& ray, Workspace& w) const;
    void hit(const PathRay& ray, const SurfacePoint& s, const HitKey& key, Workspace& w,
             RayCounts& counts) const;
    void light(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
               const Material& m, const glm::dvec3& colour, Workspace& w, RayCounts& counts) const;
    void spawn(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
               const Material& m, Workspace& w, RayCounts& counts) const;
    void child(const PathRay& parent, const SurfacePoint& s, const HitKey& key, const glm::dvec3& direction,
               const glm::dvec3& off, const glm::dvec3& throughput, NodePath::Bounce bounce,
               Workspace& w) const;
    void resolve_shadows(Workspace& w) const;
    void take_lobe(const PathRay& ray, const SurfacePoint& s, const HitKey& key, const glm::dvec3& axis,
                   const glm::dvec3& side, double exponent, const glm::dvec3& share, NodePath::Bounce bounce,
                   Workspace& w) const;
    void average_lobes(Workspace& w, RayCounts& counts) const;
    void average_extents(Workspace& w, RayCounts& counts) const;
    [[nodiscard]] bool noisy() const { return lobe_means || has_extents; }
    [[nodiscard]] bool measures_bends() const { return refocus && settings.bend_radius_m > 0; }
    // Stores a surface point that is seen in a mirror or in glass, so that its `w_bend` can be measured
    // later. `w_bend` tells how nonlinearly the point's image moves when the lens point moves. A point that
    // is seen only in flat mirrors is not stored, because its image moves linearly. `s` is the point, or null
    // if the ray hit nothing; then the background is stored.
    void keep_bent(const PathRay& ray, const SurfacePoint* s, Workspace& w) const;
    void trace_bends(Workspace& w, RayCounts& counts) const;
    // Estimates `w_bend` from earlier samples nearby, to save rays. `w_bend` tells how nonlinearly the image
    // of a mirrored or refracted point moves when the lens point moves. `w.bent` lists the points for which
    // additional rays must measure it. Where the earlier samples suffice for an estimate, the point is
    // removed from this list.
    void take_bends_around(Workspace& w, const std::function<SamplesAround(std::size_t)>& around) const;
    // Converts all surface hits of the batch to records in `out`. The hits are ordered by number of bounces.
    // The records are ordered by sample, then by layer (layer 0 is visible, the others are hidden surfaces),
    // and then by the sequence of bounces.
    void collect(Workspace& w, TracedSamples& out) const;
};

}  // namespace postlens
