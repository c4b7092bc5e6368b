#include "tracer/shading_trees/refocus_bend.h"

#include <Imath/half.h>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tracer/shading/shading.h"

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double infinity = std::numeric_limits<double>::infinity();

// Largest number of steps of Newton's method to find the ray from a lens point that reaches a given surface
// point. The steps use the derivatives of the ray through the lens centre. For other lens points, these
// derivatives are inexact, so each step reduces the error only about tenfold.
constexpr int most_steps = 5;
// Decides when Newton's method ends. It changes the direction of a ray from a lens point, step by step, until
// the ray reaches a given surface point. It ends after a step that moves the ray by at most settled_px on the
// raster. It also ends when the estimated error is at most settled_share of the result. The result is by how
// much the ray's direction deviates from a linear prediction.
constexpr double settled_share = 0.05, settled_px = 0.1;
// Newton's method approaches the sought ray in steps. The error that remains after a step is estimated as a
// fraction of the length of this step. After the first step, the fraction is this constant. After each later
// step, it is the ratio of the lengths of the last two steps.
constexpr double first_step_leaves = 0.25;
constexpr double straight_share = 0.5;

// Largest number of surfaces that a ray may pass through to reach a hidden surface behind them.
constexpr int most_passed = 16;

// A ray from a lens point. Newton's method adjusts its direction until the ray reaches a given surface point.
struct Probe {
    std::uint32_t node = 0;
    dvec2 q{0}, predicted{0}, tangent{0};
    double last_step = infinity;
    double departure = 0, unsettled = 0;  // distance of `tangent` from `predicted`; estimated residual
    bool converges = false;
    // The current part of the ray.
    dvec3 origin{0}, direction{0}, off{0};
    // Distance along the ray, m, at which tracing resumes after the ray has passed through surfaces.
    double start = 0;
    HitKey from;
    int bounces = 0, passed = 0;
    // `hidden` is true if the ray failed before its last bounce, because it hit nothing or an object other
    // than the mirror or glass that comes next on its path. `lost` is true if the ray was totally reflected
    // where it should be refracted, or if Newton's method, which searches for the ray, diverged.
    bool hidden = false, lost = false;
    [[nodiscard]] bool ended() const { return hidden || lost; }
};

class Prober {
  public:
    Prober(const RayScene& scene, const CameraModel& camera, std::span<const BentNode> nodes)
        : scene_(scene), camera_(camera), nodes_(nodes) {}

    void begin(Probe& p) const {
        p.origin = camera_.position + p.q.x * camera_.right + p.q.y * camera_.down;
        p.direction =
            glm::normalize(camera_.forward + p.tangent.x * camera_.right + p.tangent.y * camera_.down);
        p.off = dvec3(0);
        p.start = 0;
        p.from = {};
        p.bounces = p.passed = 0;
    }
    [[nodiscard]] bool on_its_way(const Probe& p) const {
        return !p.ended() && p.bounces < nodes_[p.node].path.depth();
    }
    void meet(Probe& p, const HitKey& key, double t) const {
        const BentNode& n = nodes_[p.node];
        p.hidden = true;
        if (!key.valid()) return;
        const SurfacePoint s = scene_.surface(key, p.origin, p.direction, t);
        if (s.object != n.bounces.object[static_cast<std::size_t>(p.bounces)]) {
            p.hidden = p.bounces != n.hidden_bounce || ++p.passed > most_passed;
            p.start = s.t + RayScene::offset(s.position);
            p.from = key;
            return;
        }
        p.hidden = false;
        p.lost = true;
        const Facing f = face(s, p.direction);
        const Continuation c =
            continuation(scene_.scene().materials[scene_.scene().objects[s.object].material], f, p.direction);
        double side = 1;
        if (n.path.bounce(p.bounces) == NodePath::Bounce::reflected) {
            bool inwards = false;
            p.direction = mirrored_direction(c, f, p.direction, inwards);
        } else {
            if (!c.refracts) return;
            p.direction = refracted_direction(c, f, p.direction);
            side = -1;
        }
        p.origin = s.position;
        p.off = side * RayScene::offset(s.position) * f.geometric_normal;
        p.start = 0;
        p.from = key;
        ++p.bounces;
        p.lost = false;
    }
    // Returns the next step of Newton's method, which searches for a ray from a lens point to a given surface
    // point. The step is a change of the tangent (direction) of the current ray `p` that makes the ray miss
    // the point by less. The derivatives of `p` are not known. Instead, those of the ray from the lens centre
    // to this point are used, because they are similar.
    [[nodiscard]] dvec2 correction(const Probe& p) const {
        const BentNode& n = nodes_[p.node];
        const dvec3 miss = n.at_infinity ? p.direction - n.target : p.origin - n.target;
        // Only the component perpendicular to the ray matters.
        const auto across = [](const dvec3& v, const dvec3& d) { return v - d * glm::dot(v, d); };
        const dvec3 r = across(miss, p.direction);
        const dvec3 a = across(n.by_tangent[0], n.direction), b = across(n.by_tangent[1], n.direction);
        const double aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b);
        const double ar = glm::dot(a, r), br = glm::dot(b, r), det = aa * bb - ab * ab;
        return dvec2(bb * ar - ab * br, aa * br - ab * ar) / -det;
    }

  private:
    const RayScene& scene_;
    const CameraModel& camera_;
    std::span<const BentNode> nodes_;
};

// Traces rays for Newton's method. Each probe searches for the direction in which a ray from a lens point
// reaches a given surface point. This function traces the current ray of every unfinished search, whose index
// is in `open`. It follows the ray through all reflections and refractions of its path; whether the last part
// then hits the point is tested elsewhere.
void follow(const RayScene& scene, const Prober& prober, std::vector<Probe>& probes,
            const std::vector<std::uint32_t>& open, std::uint64_t& rays_spent) {
    thread_local RayBatch batch;
    thread_local std::vector<std::uint32_t> going;
    for (const std::uint32_t i : open) prober.begin(probes[i]);
    for (;;) {
        going.clear();
        batch.clear(true);
        for (const std::uint32_t i : open) {
            const Probe& p = probes[i];
            if (!prober.on_its_way(p)) continue;
            going.push_back(i);
            batch.add(p.origin + p.off + p.start * p.direction, p.direction,
                      std::numeric_limits<float>::infinity(), p.from);
        }
        if (going.empty()) return;
        rays_spent += going.size();
        scene.intersect(batch, false);
        for (std::size_t k = 0; k < going.size(); ++k) {
            Probe& p = probes[going[k]];
            prober.meet(p, batch.hit(k), p.start + static_cast<double>(batch.t[k]));
        }
    }
}

}  // namespace

namespace {

/// Newton's method has failed if the tangent of a ray's angle to the optical axis exceeds this value.
constexpr double widest_tangent = 1e3;

bool runs_away(const dvec2& tangent) {
    return !(glm::length(tangent) < widest_tangent);
}

/// Finds, by Newton's method, rays that start at lens points, follow given mirrors and glass objects and
/// reach given surface points. The ray through the lens centre is known for each surface point. From it, a
/// linear function predicts the tangent (slopes) of the ray from another lens point. The deviation of the
/// exact tangent from this prediction is called departure.
struct Search {
    std::vector<Probe> probes;
    std::vector<std::uint32_t> open;  ///< indices of the probes that have not converged
    // Per node:
    std::vector<bool> ended;  ///< one of its rays is lost
    /// Per node, the greatest departure of its converged rays.
    std::vector<double> greatest;
    std::vector<double> at_least;

    void begin(std::span<const BentNode> nodes) {
        probes.clear();
        ended.assign(nodes.size(), false);
        greatest.assign(nodes.size(), 0);
        at_least.assign(nodes.size(), 0);
    }
    void add(const BentNode& n, std::uint32_t node, const dvec2& q) {
        Probe p;
        p.node = node;
        p.q = q;
        p.predicted =
            n.tangent - dvec2(static_cast<double>(n.w.xx) * q.x + static_cast<double>(n.w.xy) * q.y,
                              static_cast<double>(n.w.yx) * q.x + static_cast<double>(n.w.yy) * q.y);
        p.tangent = p.predicted;
        open.push_back(static_cast<std::uint32_t>(probes.size()));
        probes.push_back(p);
    }
    void settle(const RayScene& scene, const Prober& prober, double settled_tangent,
                std::uint64_t& rays_spent);
    [[nodiscard]] static double departure(const Probe& p) {
        return p.lost || !p.converges || runs_away(p.tangent) ? infinity : p.departure + p.unsettled;
    }

  private:
    void correct(const Prober& prober, bool first_step);
};

void Search::correct(const Prober& prober, bool first_step) {
    for (const std::uint32_t i : open) at_least[probes[i].node] = greatest[probes[i].node];
    for (const std::uint32_t i : open) {
        Probe& p = probes[i];
        // Ends all searches for rays to this surface point if one of them failed (`lost`), i.e. no ray from
        // its lens point to the surface point was found. The result for the surface point, `w_bend`, tells
        // how nonlinearly its image moves when the lens point moves. It is then infinite, whatever the other
        // rays would show.
        if (p.lost) ended[p.node] = true;
        if (p.ended()) continue;
        const dvec2 change = prober.correction(p);
        const double length = glm::length(change);
        const double leaves = first_step ? first_step_leaves : length / p.last_step;
        p.tangent += change;
        p.last_step = length;
        p.departure = glm::length(p.tangent - p.predicted);
        p.converges = leaves < 1;
        p.unsettled = p.converges ? leaves * length : length;
        at_least[p.node] = std::max(at_least[p.node], p.departure - p.unsettled);
    }
}

void Search::settle(const RayScene& scene, const Prober& prober, double settled_tangent,
                    std::uint64_t& rays_spent) {
    for (int step = 0; step < most_steps && !open.empty(); ++step) {
        for (const std::uint32_t i : open) probes[i].lost = runs_away(probes[i].tangent);
        follow(scene, prober, probes, open, rays_spent);
        correct(prober, step == 0);
        std::erase_if(open, [&](std::uint32_t i) {
            Probe& p = probes[i];
            if (ended[p.node] || p.hidden) return true;
            // Ends the search for this ray early if it cannot change the result. `departure` tells how much
            // the ray's direction deviates from a linear prediction. The result for the surface point is only
            // the largest departure of all rays to it. So the ray need not be found exactly if its departure
            // is certainly smaller than that of another ray, `at_least`.
            const bool smaller = p.converges && p.departure + p.unsettled < at_least[p.node];
            const bool settled = p.last_step <= settled_tangent ||
                                 (step > 0 && p.converges && p.unsettled <= settled_share * p.departure);
            if (!smaller && !settled) return false;
            p.unsettled = 0;
            p.converges = true;
            greatest[p.node] = std::max(greatest[p.node], p.departure);
            return true;
        });
    }
    open.clear();
}

}  // namespace

void measure_bends(const RayScene& scene, const CameraModel& camera, double radius_m,
                   std::span<const BentNode> nodes, std::vector<float>& out, std::uint64_t& rays_spent) {
    thread_local Search search;
    search.begin(nodes);
    const Prober prober(scene, camera, nodes);
    const double settled_tangent = settled_px * camera.tangent_per_px;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        for (const dvec2 q : {dvec2(1, 0), dvec2(0, 1)}) search.add(nodes[i], i, radius_m * q);
    }
    search.settle(scene, prober, settled_tangent, rays_spent);
    // A ray's departure is the deviation of its direction from a linear prediction, where the prediction is
    // exact for the lens centre. The departure grows with the square of the distance from the centre. So the
    // rays from two opposite lens points have almost equal departures. The opposite lens points, -q, are
    // therefore used only where the departure is large, i.e. where `straight` is false.
    std::vector<bool> straight(nodes.size(), true);
    for (const Probe& p : search.probes) {
        if (p.hidden || !(Search::departure(p) <= straight_share * settled_tangent)) straight[p.node] = false;
    }
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (straight[i] || search.ended[i]) continue;
        for (const dvec2 q : {dvec2(-1, 0), dvec2(0, -1)}) search.add(nodes[i], i, radius_m * q);
    }
    search.settle(scene, prober, settled_tangent, rays_spent);
    out.assign(nodes.size(), -1);
    for (const Probe& p : search.probes) {
        if (p.hidden) continue;
        const float rounded = Imath::half(static_cast<float>(Search::departure(p) / (radius_m * radius_m)));
        out[p.node] = std::max(out[p.node], rounded);
    }
    // `out` holds `w_bend` of each surface point, which tells how nonlinearly its image moves when the lens
    // point moves. Rays from several lens points measure it. It is still negative if none of these rays
    // completed the bounces of the path, because each of them hit another object or nothing before. Then
    // `w_bend` is unknown, and infinity stands for this.
    for (float& bend : out) {
        if (bend < 0) bend = std::numeric_limits<float>::infinity();
    }
}

}  // namespace postlens
