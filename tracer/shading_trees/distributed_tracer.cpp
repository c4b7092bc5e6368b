#include "tracer/shading_trees/distributed_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tracer/shading/radiance_bounds.h"

namespace postlens {
namespace {

using glm::dvec3;

// Kinds of random decisions at a surface hit. Each has its own set of random points (sample_set).
enum class Purpose : std::uint32_t { light = 1, reflection = 2, transmission = 3, roulette = 4 };

SampleSet set_for(Purpose purpose, NodePath path, std::size_t which) {
    return sample_set(static_cast<std::uint32_t>(purpose), path.bits(), static_cast<std::uint32_t>(which));
}

constexpr std::uint32_t no_node = 0xFFFFFFFFU;

struct Shadow {
    std::uint32_t sample = 0;
    std::uint32_t node = no_node;
    dvec3 radiance{0};
};

/// Collects the radiance of a surface hit that may not exceed the limit LightElsewhere::above. Radiance above
/// the limit is excluded here, because it is added to the image separately, as highlights. Several light
/// sources contribute to the hit's radiance, but the limit applies to their sum. So `radiance` first collects
/// the sum, and the limit is applied afterwards.
struct LimitedNode {
    std::uint32_t sample = 0;
    dvec3 radiance{0};
    bool counts = false;  ///< see add_limited
};

void add_limited(const dvec3& radiance, std::size_t ray, bool counts, EyeRays& eye) {
    const dvec3 kept = glm::min(radiance, dvec3(static_cast<double>(eye.less->above)));
    eye.radiance[ray] += kept;
    if (counts) eye.left_out[ray] += radiance - kept;
}

}  // namespace

struct DistributedTracer::PathRay {
    dvec3 origin{0}, direction{0}, throughput{1};
    std::uint32_t sample = 0;
    float time = 0;
    NodePath path;
    std::uint32_t parent_id = 0;
};

// Buffers of one thread, reused for every batch.
struct DistributedTracer::Workspace {
    std::vector<PathRay> rays, next_rays;
    RayBatch batch, next_batch;
    std::vector<Shadow> shadows;
    RayBatch shadow_rays;
    std::vector<LimitedNode> limited;
};

dvec3 spread_direction(const dvec3& axis, double exponent, const glm::dvec2& uv) {
    if (exponent == std::numeric_limits<double>::infinity()) return axis;
    // Samples a cos^n lobe by inverting the cumulative distribution c^(n + 1) of the cosine c.
    const double cosine = std::pow(1 - uv.x, 1 / (exponent + 1));
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), turn = 2 * std::numbers::pi * uv.y;
    const dvec3 hint = std::abs(axis.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    const dvec3 x = glm::normalize(hint - axis * glm::dot(hint, axis)), y = glm::cross(axis, x);
    return glm::normalize(sine * std::cos(turn) * x + sine * std::sin(turn) * y + cosine * axis);
}

DistributedTracer::DistributedTracer(const RayScene& scene, const Sampler& sampler,
                                     const DistributedSettings& settings)
    : scene_(scene), sampler_(sampler), settings_(settings) {
    settings_.max_depth = std::clamp(settings.max_depth, 1, NodePath::max_bounces + 1);
    bound_ = radiance_bounds(scene.scene(), settings_.max_depth);
    const TimeSpan& span = scene.span();
    for (const Object& o : scene.scene().objects) {
        const Material& m = scene.scene().materials[o.material];
        const bool spawns = (m.reflects() || m.transmission != dvec3(0)) && settings_.max_depth > 1;
        const bool lit = !scene.scene().lights.empty() && m.answers_lights();
        const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&o.shape);
        const bool coloured = mesh != nullptr && !(*mesh)->colours.empty();
        const bool textured = m.colour_texture != nullptr || m.emission_texture != nullptr || coloured;
        answers_.push_back(spawns || lit ? Answer::full : textured ? Answer::texture : Answer::constant);
        constant_.push_back(textured ? dvec3(0) : own_radiance(scene.scene(), m, {}, dvec3(1)));
    }
    for (const Light& l : scene.scene().lights) {
        lights_.push_back(place_light(l, span.open_s));
        light_paths_.emplace_back(l.keys);
        light_moves_.push_back(light_paths_.back().moves(span.open_s, span.close_s));
        moving_lights_ = moving_lights_ || light_moves_.back();
    }
}

void DistributedTracer::light(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
                              const Material& m, const dvec3& colour, std::uint32_t limited, EyeRays& eye,
                              Workspace& w, RayCounts& counts) const {
    const std::size_t sample = ray.sample;
    for (std::size_t i = 0; i < lights_.size(); ++i) {
        PlacedLight moved;
        if (light_moves_[i]) {
            const double time_s = scene_.span().at(static_cast<double>(ray.time));
            moved = place_light(*lights_[i].light, light_paths_[i].at(time_s).matrix());
        }
        const PlacedLight& placed = light_moves_[i] ? moved : lights_[i];
        dvec3 at = placed.position;
        if (placed.light->has_extent()) {
            const glm::vec2 uv =
                sampler_.point_2d(eye.pixel[sample], set_for(Purpose::light, ray.path, i), eye.index[sample]);
            at = light_point(placed, s.position, glm::dvec2(uv));
        }
        const Lit lit = lit_by(placed, at, s, f, m, colour, ray.direction);
        if (lit.radiance == dvec3(0)) continue;
        const dvec3 radiance = ray.throughput * lit.radiance;
        if (!lit.casts_shadow) {
            (limited == no_node ? eye.radiance[sample] : w.limited[limited].radiance) += radiance;
            continue;
        }
        ++counts.shadow;
        w.shadows.push_back({ray.sample, limited, radiance});
        w.shadow_rays.add(lit.origin, lit.segment, lit.reach, key, ray.time);
    }
}

void DistributedTracer::spawn(const PathRay& ray, const SurfacePoint& s, const Facing& f, const HitKey& key,
                              const Material& m, const EyeRays& eye, Workspace& w, RayCounts& counts) const {
    const int left = settings_.max_depth - 1 - ray.path.depth();
    if (left < 1) return;
    const Continuation c = continuation(m, f, ray.direction);
    const std::size_t sample = ray.sample;
    const auto follow = [&](dvec3 direction, double exponent, const dvec3& share, double side,
                            Purpose purpose, NodePath::Bounce bounce, std::uint64_t& count) {
        if (!eye.left_out_of.empty() && !ray.path.child(bounce).begins(eye.left_out_of[sample].path)) return;
        dvec3 throughput = ray.throughput * share;
        const double importance = eye.importance.empty() ? 1 : eye.importance[sample];
        if (!(largest(throughput) > 0) ||
            importance * largest(throughput) * bound_[static_cast<std::size_t>(left)] <
                settings_.min_contribution) {
            return;
        }
        if (const double survival = largest(share); settings_.roulette && survival < 1) {
            const glm::vec2 uv = sampler_.point_2d(
                eye.pixel[sample], set_for(Purpose::roulette, ray.path.child(bounce), 0), eye.index[sample]);
            if (static_cast<double>(uv.x) >= survival) return;
            throughput /= survival;
        }
        const dvec3 off = side * f.geometric_normal;
        if (std::isfinite(exponent)) {
            const glm::vec2 uv =
                sampler_.point_2d(eye.pixel[sample], set_for(purpose, ray.path, 0), eye.index[sample]);
            direction = spread_direction(direction, exponent, glm::dvec2(uv));
            // A random direction in a glossy lobe may point to the wrong side of the surface. It is mirrored
            // at the surface, so that no light of the lobe is lost.
            const double through = glm::dot(direction, off);
            if (through < 0) direction -= 2 * through * off;
        }
        ++count;
        w.next_rays.push_back({s.position, direction, throughput, ray.sample, ray.time,
                               ray.path.child(bounce), scene_.scene().objects[s.object].id});
        w.next_batch.add(s.position + RayScene::offset(s.position) * off, direction,
                         std::numeric_limits<float>::infinity(), key, ray.time);
    };
    if (c.reflected != dvec3(0)) {
        bool inwards = false;
        follow(mirrored_direction(c, f, ray.direction, inwards), m.reflection_exponent, c.reflected, 1,
               Purpose::reflection, NodePath::Bounce::reflected, counts.reflect);
    }
    if (c.refracts) {
        follow(refracted_direction(c, f, ray.direction), m.transmission_exponent, c.transmitted, -1,
               Purpose::transmission, NodePath::Bounce::transmitted, counts.refract);
    }
}

void DistributedTracer::shade(const PathRay& ray, const SurfacePoint& s, const HitKey& key, EyeRays& eye,
                              Workspace& w, RayCounts& counts) const {
    const Scene& scene = scene_.scene();
    const Material& m = scene.materials[scene.objects[s.object].material];
    const bool spawns = m.reflects() || m.transmission != dvec3(0);
    const bool is_wanted = wants_light(ray, s.object, eye);
    const bool answers = is_wanted && !lights_.empty() && m.answers_lights();
    const dvec3 colour = is_wanted ? surface_colour(m, s) : dvec3(0);
    std::uint32_t limited = no_node;
    if (is_wanted) {
        const dvec3 own = ray.throughput * own_radiance(scene, m, s, colour);
        if (limits(ray, s.object, s.t, eye)) {
            limited = static_cast<std::uint32_t>(w.limited.size());
            w.limited.push_back({ray.sample, own, counts_as_left_out(ray, s.object, eye)});
        } else {
            eye.radiance[ray.sample] += own;
        }
    }
    if (!spawns && !answers) return;
    const Facing f = face(s, ray.direction);
    if (answers) light(ray, s, f, key, m, colour, limited, eye, w, counts);
    if (spawns) spawn(ray, s, f, key, m, eye, w, counts);
}

bool DistributedTracer::limits(const PathRay& ray, std::uint32_t object, double t, const EyeRays& eye) const {
    if (eye.less == nullptr) return false;
    const std::uint32_t id = scene_.scene().objects[object].id;
    return std::binary_search(eye.less->ids.begin(), eye.less->ids.end(), id) &&
           eye.less->of(ray.path, ray.parent_id, id,
                        ray.path.bits() == 0 ? eye.recorded_at(ray.sample, t) : glm::dvec2(0));
}

bool DistributedTracer::counts_as_left_out(const PathRay& ray, std::uint32_t object,
                                           const EyeRays& eye) const {
    return !eye.left_out_of.empty() &&
           eye.left_out_of[ray.sample] ==
               NodeIdentity{ray.path, ray.parent_id, scene_.scene().objects[object].id};
}

void DistributedTracer::resolve_shadows(EyeRays& eye, Workspace& w) const {
    if (w.shadow_rays.count != 0) scene_.occlude(w.shadow_rays);
    for (std::size_t k = 0; k < w.shadows.size(); ++k) {
        const Shadow& s = w.shadows[k];
        (s.node == no_node ? eye.radiance[s.sample] : w.limited[s.node].radiance) +=
            s.radiance * w.shadow_rays.transmittance[k];
    }
    for (const LimitedNode& n : w.limited) add_limited(n.radiance, n.sample, n.counts, eye);
}

void DistributedTracer::trace(EyeRays& eye, RayCounts& counts) const {
    thread_local Workspace w;
    const auto count = static_cast<std::size_t>(eye.rays.count);
    eye.radiance.assign(count, dvec3(0));
    eye.left_out.assign(eye.less != nullptr ? count : 0, dvec3(0));
    counts.eye += count;
    scene_.intersect(eye.rays, coherent() && !eye.rays.has_sources);

    const bool times = needs_times();
    const auto begin = [&] {
        w.next_rays.clear();
        w.next_batch.clear(true, times);
        w.shadows.clear();
        w.shadow_rays.clear(true, times);
        w.limited.clear();
    };
    begin();
    const RayBatch& b = eye.rays;
    const dvec3 background = scene_.scene().background;
    for (std::size_t i = 0; i < count; ++i) {
        const HitKey key = b.hit(i);
        if (!key.valid()) {
            eye.radiance[i] = background;
            continue;
        }
        ++counts.eye_hits;
        const std::uint32_t object = scene_.object(key);
        PathRay ray;
        ray.sample = static_cast<std::uint32_t>(i);
        const bool limited = limits(ray, object, static_cast<double>(b.t[i]), eye);
        const auto see = [&](const dvec3& radiance) {
            if (limited)
                add_limited(radiance, i, counts_as_left_out(ray, object, eye), eye);
            else
                eye.radiance[i] = radiance;
        };
        if (answers_[object] == Answer::constant) {
            see(constant_[object]);
            continue;
        }
        ray.origin = dvec3(glm::vec3(b.ox[i], b.oy[i], b.oz[i]));
        ray.direction = glm::normalize(dvec3(glm::vec3(b.dx[i], b.dy[i], b.dz[i])));
        ray.time = times ? b.time[i] : 0.0F;
        const auto t = static_cast<double>(b.t[i]), time = static_cast<double>(ray.time);
        if (answers_[object] == Answer::texture) {
            const Material& m = scene_.scene().materials[scene_.scene().objects[object].material];
            const SurfacePoint s = scene_.texture_point(key, ray.origin, ray.direction, t, time);
            see(own_radiance(scene_.scene(), m, s, surface_colour(m, s)));
            continue;
        }
        shade(ray, scene_.surface(key, ray.origin, ray.direction, t, time), key, eye, w, counts);
    }
    resolve_shadows(eye, w);
    while (!w.next_rays.empty()) {
        std::swap(w.rays, w.next_rays);
        std::swap(w.batch, w.next_batch);
        begin();
        scene_.intersect(w.batch, false);
        for (std::size_t i = 0; i < w.rays.size(); ++i) {
            const PathRay& ray = w.rays[i];
            const HitKey key = w.batch.hit(i);
            if (!key.valid()) {
                eye.radiance[ray.sample] += ray.throughput * background;
                continue;
            }
            const auto t = static_cast<double>(w.batch.t[i]), time = static_cast<double>(ray.time);
            shade(ray, scene_.surface(key, ray.origin, ray.direction, t, time), key, eye, w, counts);
        }
        resolve_shadows(eye, w);
    }
}

}  // namespace postlens
