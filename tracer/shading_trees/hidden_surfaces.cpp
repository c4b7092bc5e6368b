#include "tracer/shading_trees/hidden_surfaces.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

#include "tracer/shading/shading.h"

namespace postlens {
namespace {

using glm::dvec2;
using glm::dvec3;
using Places = std::vector<std::optional<dvec2>>;

// Largest number of surfaces through which one ray is followed. It limits the time for rays through foliage.
constexpr int most_crossings = 256;

bool is_flat(const Shape& shape) {
    return std::holds_alternative<Rectangle>(shape) || std::holds_alternative<Disc>(shape) ||
           std::holds_alternative<Plane>(shape);
}

// A ray that is followed through all surfaces on its line.
struct Chain {
    std::uint32_t ray = 0;
    HitKey key;           // last hit
    double t = 0;         // distance of the last hit, m
    double here_t = 0;    // distance, m, of the first of the hits that coincide with the last one
    bool beyond = false;  // the ray continues from behind t, not from just before t
    int crossings = 0;
    int layers = 0;                      // number of surfaces hit so far
    int kept = 0;                        // number of hidden surfaces returned so far
    bool goes_on = false;                // the ray needs further hits
    bool still = false;                  // one of the surfaces so far does not move
    std::vector<std::uint32_t> entered;  // parts whose inside contains the end of the ray so far
    struct Met {
        std::uint32_t object;
        bool leaving;
    };
    std::vector<Met> here;       // coincident hits at here_t
    std::vector<Places> places;  // for each surface so far, its raster positions at all instants
    LensReach::Covers covers;    // inverse depths of the surfaces so far

    void restart(std::uint32_t of) {
        ray = of;
        beyond = goes_on = still = false;
        crossings = layers = kept = 0;
        entered.clear();
        here.clear();
        places.clear();
    }
};

class Follower {
  public:
    Follower(const RayScene& scene, const HiddenLayers& wanted, std::span<const FirstHit> eye,
             std::vector<HiddenHit>& out)
        : scene_(scene), wanted_(wanted), eye_(eye), out_(out) {}

    bool begin(std::uint32_t ray, Chain& c) {
        const FirstHit& e = eye_[ray];
        if (!e.key.valid()) return false;
        c.restart(ray);
        c.covers = {e.at, e.path, e.parent, 0, 0, e.inverse_depth_limit()};
        meet(c, e.key, e.surface);
        return c.goes_on;
    }

    // Returns the distance, m, along the ray `c` at which the search for further surfaces resumes. Normally,
    // this is slightly in front of the last hit, because another surface may lie at the same distance. If the
    // ray has then hit the same surface again (`beyond`), the search resumes slightly behind the hit.
    [[nodiscard]] double start(const Chain& c) const {
        const double step = RayScene::offset(eye_[c.ray].origin + c.t * eye_[c.ray].direction);
        return c.beyond ? c.t + step : c.t - step;
    }

    bool advance(Chain& c, const HitKey& key, double t) {
        if (++c.crossings == most_crossings) return false;
        const FirstHit& e = eye_[c.ray];
        if (!key.valid()) {
            take(c, key, {});
            return false;
        }
        meet(c, key, scene_.surface(key, e.origin, e.direction, t));
        // Decides whether the ray is continued behind this hit, to find further hidden surfaces. If surfaces
        // that motion may reveal are searched for, needs_more() decides anew after every hit, because the
        // search can end as soon as no moving object lies ahead. Otherwise, the answer changes only when a
        // surface is added, so the answer of that time, `goes_on`, is used.
        return by_motion(c) ? needs_more(c) : c.goes_on;
    }

  private:
    // Handles the next hit of a ray that is continued behind its first hit, to find hidden surfaces. `c`
    // describes all surfaces that the ray has passed, and the new surface is added to it. Two kinds of hits
    // are no new surfaces and are skipped. One is a hit where the ray leaves an object that it has entered
    // before. The other is a hit of the same surface again, because the search resumes slightly in front of
    // the last hit.
    void meet(Chain& c, const HitKey& key, const SurfacePoint& s) {
        const FirstHit& e = eye_[c.ray];
        const bool leaving = glm::dot(e.direction, s.geometric_normal) >= 0;
        const bool coincides = !c.here.empty() && s.t <= c.here_t + 4 * RayScene::offset(s.position);
        if (!coincides) {
            c.here.clear();
            c.here_t = s.t;
        }
        c.key = key;
        c.t = coincides ? std::max(c.t, s.t) : s.t;
        const bool again = std::any_of(c.here.begin(), c.here.end(), [&](const Chain::Met& m) {
            return m.object == s.object && m.leaving == leaving;
        });
        c.beyond = again;
        if (again) return;
        c.here.push_back({s.object, leaving});
        // A hit where the ray leaves an object that it has entered is not a new surface. So it is tracked
        // which objects the ray is inside of. This is done for each connected part of an object, such as each
        // leaf of a tree, because a ray inside one leaf may meet the back of another leaf before it leaves
        // the first.
        const std::uint32_t part =
            wanted_.parts != nullptr ? wanted_.parts->part(s.object, key.primitive) : s.object;
        const auto inside = std::find(c.entered.begin(), c.entered.end(), part);
        if (leaving && inside != c.entered.end()) {
            c.entered.erase(inside);
            return;
        }
        const Object& object = scene_.scene().objects[s.object];
        if (!leaving && inside == c.entered.end() && !is_flat(object.shape)) c.entered.push_back(part);
        if (wanted_.motion != nullptr && !wanted_.motion->moves(object.id)) c.still = true;
        take(c, key, s);
    }

    void take(Chain& c, const HitKey& key, const SurfacePoint& s) {
        const int layer = c.layers++;
        const bool visible = layer == 0;
        const bool seen_past = wanted_.lens != nullptr && lens_sees(c, key, s);
        if (visible) c.goes_on = needs_more(c);
        if (visible && !c.goes_on) return;  // ends most rays of a scene in which little moves
        const bool uncovered = by_motion(c) && comes_to_light(c, key, s);
        if (visible) return;
        if (wanted_.all() || seen_past || uncovered) {
            ++c.kept;
            HiddenHit& hit = out_.emplace_back();
            hit.ray = c.ray;
            hit.layer = static_cast<std::uint32_t>(layer);
            hit.key = key;
            hit.surface = s;
        }
        c.goes_on = key.valid() && needs_more(c);
    }

    [[nodiscard]] bool needs_more(const Chain& c) const {
        if (c.layers > wanted_.count) return false;
        if (wanted_.all()) return true;
        if (c.kept >= (by_motion(c) ? HiddenLayers::most_uncovered : HiddenLayers::most_seen_past))
            return false;
        return may_come_to_light(c) || (wanted_.lens != nullptr && wanted_.lens->may_see_past(c.covers));
    }

    [[nodiscard]] bool by_motion(const Chain& c) const {
        return wanted_.motion != nullptr && c.covers.path.bits() == 0;
    }

    [[nodiscard]] bool may_come_to_light(const Chain& c) const {
        if (!by_motion(c)) return false;
        // Decides whether the ray may still find a hidden surface that motion reveals. A surface at rest can
        // appear from behind another one at rest only by parallax, i.e. if the camera changes its position.
        // Without parallax, once the ray has passed a surface at rest (`still`), only moving objects can be
        // revealed. Then the ray is continued only if it may hit one.
        if (!c.still || wanted_.motion->parallax()) return true;
        const FirstHit& e = eye_[c.ray];
        return wanted_.motion->may_meet_moving(e.origin, e.direction, c.t);
    }

    // Returns true if some point of the lens may see surface `s`, which the ray hits behind other surfaces.
    // From the lens centre, those surfaces hide `s`. From another lens point, they are shifted in the image
    // relative to `s`, and so may reveal it.
    [[nodiscard]] bool lens_sees(Chain& c, const HitKey& key, const SurfacePoint& s) const {
        const FirstHit& e = eye_[c.ray];
        double inverse_depth = 0;
        if (e.path.bits() != 0) {
            RayDifferentials d = e.differentials;
            if (key.valid()) transfer(d, e.direction, s.t, s.geometric_normal);
            inverse_depth = key.valid() ? LensReach::inverse_depth(refocus_matrix(d)) : c.covers.limit;
        } else if (key.valid()) {
            inverse_depth = 1 / (s.t * e.cos_axis);
        }
        const bool first = c.layers == 1;
        // Tests whether some lens point sees surface `s` past the surfaces in front of it. The farther `s`
        // lies behind them, the more of it a lens point sees. If `s` is a mirror or glass, its images may
        // appear far behind it, so a lens point may see an image where it does not see the rest of `s`.
        // Therefore, such a surface is also tested as if it were infinitely distant.
        const bool seen = !first && (wanted_.lens->may_see(c.covers, inverse_depth) ||
                                     (key.valid() && shows_more(s) && wanted_.lens->may_see_past(c.covers)));
        if (first) c.covers.nearest = c.covers.farthest = inverse_depth;
        c.covers.nearest = std::max(c.covers.nearest, inverse_depth);
        c.covers.farthest = std::min(c.covers.farthest, inverse_depth);
        return seen;
    }

    [[nodiscard]] bool shows_more(const SurfacePoint& s) const {
        const Material& m = scene_.scene().materials[scene_.scene().objects[s.object].material];
        const double radius = wanted_.lens->aperture_radius_m();
        return (m.reflects() && !lobe_is_wide(m.reflection_exponent, radius, s.t)) ||
               (m.transmission != glm::dvec3(0) && !lobe_is_wide(m.transmission_exponent, radius, s.t));
    }

    // Returns true if motion may reveal surface `s`, which the ray hits behind other surfaces. A surface in
    // front continues to hide `s` if both move by the same displacement on the raster. So the result is true
    // only if, for every surface in front, the raster positions of this surface and of `s` move apart at some
    // instant.
    [[nodiscard]] bool comes_to_light(Chain& c, const HitKey& key, const SurfacePoint& s) const {
        const FirstHit& e = eye_[c.ray];
        Places mine(wanted_.motion->instants());
        for (std::size_t i = 0; i < mine.size(); ++i) {
            mine[i] = key.valid() ? wanted_.motion->place(scene_.scene().objects[s.object].id, s.position, i)
                                  : wanted_.motion->place_of_nothing(e.direction, e.at, i);
        }
        const auto part = [&](const Places& other) {
            for (std::size_t i = 0; i < mine.size(); ++i) {
                if (mine[i].has_value() != other[i].has_value()) return true;
                if (mine[i] && glm::length(*mine[i] - *other[i]) > wanted_.same_place_px) return true;
            }
            return false;
        };
        const bool wanted = std::all_of(c.places.begin(), c.places.end(), part);
        c.places.push_back(std::move(mine));
        return wanted;
    }

    const RayScene& scene_;
    const HiddenLayers& wanted_;
    std::span<const FirstHit> eye_;
    std::vector<HiddenHit>& out_;
};

// Sorts hidden surfaces by the index of the ray that found them. Those of one ray keep their order.
void order_by_ray(const std::vector<HiddenHit>& found, std::size_t rays, std::vector<HiddenHit>& out) {
    thread_local std::vector<std::uint32_t> next;
    next.assign(rays + 1, 0);
    for (const HiddenHit& h : found) ++next[h.ray + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    out.resize(found.size());
    for (const HiddenHit& h : found) out[next[h.ray]++] = h;
}

}  // namespace

double FirstHit::inverse_depth_limit() const {
    return path.bits() == 0 ? 0 : LensReach::inverse_depth(refocus_matrix_at_infinity(differentials));
}

void find_hidden_surfaces(const RayScene& scene, const HiddenLayers& wanted, std::span<const FirstHit> eye,
                          std::vector<HiddenHit>& out, std::uint64_t& rays_spent) {
    struct Buffers {
        std::vector<Chain> chains;  // kept for the memory of their vectors
        std::vector<std::uint32_t> open;
        std::vector<HiddenHit> found;
        RayBatch batch;
    };
    thread_local Buffers buffers;
    auto& [chains, open, found, batch] = buffers;
    open.clear();
    found.clear();
    if (chains.size() < eye.size()) chains.resize(eye.size());
    Follower follower(scene, wanted, eye, found);
    for (std::uint32_t i = 0; i < eye.size(); ++i) {
        if (follower.begin(i, chains[i])) open.push_back(i);
    }
    while (!open.empty()) {
        batch.clear(true);
        for (const std::uint32_t i : open) {
            const FirstHit& e = eye[i];
            batch.add(e.origin + follower.start(chains[i]) * e.direction, e.direction,
                      std::numeric_limits<float>::infinity(), chains[i].key);
        }
        scene.intersect(batch, false);
        rays_spent += open.size();
        std::size_t left = 0;
        for (std::size_t k = 0; k < open.size(); ++k) {
            Chain& c = chains[open[k]];
            const double t = follower.start(c) + static_cast<double>(batch.t[k]);
            if (follower.advance(c, batch.hit(k), t)) open[left++] = open[k];
        }
        open.resize(left);
    }
    order_by_ray(found, eye.size(), out);
}

}  // namespace postlens
