#include "tracer/shading_trees/lobe_means.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "core/sample_hash.h"
#include "core/sobol.h"
#include "pictures/srgb.h"
#include "tracer/shading/radiance_bounds.h"

namespace postlens {
namespace {

using glm::dvec3;

constexpr double target_noise = 1.0 / 510;  // standard deviation of encoded image values
// Upper limit of the weight of a ray. The ray of one surface hit is used also for hits nearby, to compute the
// mean radiance that arrives from the directions of their glossy lobes. In each of these means, the ray has a
// weight. A mean in which single rays have high weights is noisy, so the weights are limited.
constexpr double most_weight = 8;

// Returns true if the glossy lobes of two surface hits overlap so much that the hits may share rays to
// compute the mean radiance over their lobes. The axes of the lobes must differ by less than the width of the
// wider lobe.
bool overlap(const LobeHit& a, const LobeHit& b) {
    const double width2 = 1 / std::max(1.0, std::min(a.exponent, b.exponent));
    return glm::dot(a.axis, b.axis) > 1 - width2 / 2;
}

// Returns one of the factors of the weight with which rays of the surface hit `b` count for the surface hit
// `a`. To compute the mean radiance over its glossy lobe, `a` reuses rays of hits nearby. The factor
// decreases with the distance between the two hits on the raster, and is 0 from the distance `reach_px` on.
// So no hit appears or vanishes suddenly, and the mean changes continuously over the image.
double window(const LobeHit& a, const LobeHit& b) {
    const glm::dvec2 d = a.at - b.at;
    const double share = 1 - glm::dot(d, d) / (LobeMeans::reach_px * LobeMeans::reach_px);
    return share > 0 ? share * share : 0;
}

// Returns the index of the raster position `at`, px, on a Morton curve, which visits all points of a grid
// with a spacing of 1/4 px. Surface hits with glossy lobes are sorted by this index, and in this order take
// successive points of a stratified random sequence. The curve mostly visits neighbours one after another. So
// the random rays of hits that are close together are well distributed.
//
// 16 bits per coordinate distinguish positions within 16384 px, which is enough for a batch of hits.
std::uint32_t curve_index(const glm::dvec2& at) {
    const auto spread = [](double v) {
        auto bits = static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(4 * v))) & 0xFFFFU;
        bits = (bits | bits << 8) & 0x00FF00FFU;
        bits = (bits | bits << 4) & 0x0F0F0F0FU;
        bits = (bits | bits << 2) & 0x33333333U;
        return (bits | bits << 1) & 0x55555555U;
    };
    return spread(at.x) | spread(at.y) << 1;
}

std::uint64_t seed_of(const LobeHit& h) {
    const auto x = std::bit_cast<std::uint64_t>(h.at.x), y = std::bit_cast<std::uint64_t>(h.at.y);
    return mix64(mix64(mix64(x) ^ y) ^ (static_cast<std::uint64_t>(h.object) << 32 | h.path.bits()));
}

// Returns a scrambled Sobol point, from which a direction in a glossy lobe is sampled.
// Points of successive indices are evenly distributed over the unit square (stratified).
glm::dvec2 lobe_point(std::uint64_t seed, std::uint32_t index) {
    const auto coordinate = [&](int dimension) {
        const auto key = static_cast<std::uint32_t>(mix64(seed + static_cast<std::uint64_t>(dimension)));
        return static_cast<double>(
            unit_float(reverse_bits(owen_scramble_reversed(sobol_reversed(dimension, index), key))));
    };
    return {coordinate(0), coordinate(1)};
}

double power(double cosine, double exponent) {
    return cosine > 0 ? static_cast<double>(
                            std::exp2(static_cast<float>(exponent) * std::log2(static_cast<float>(cosine))))
                      : 0;
}

// Returns the slope of the sRGB curve per channel.
dvec3 encoded_slope(const dvec3& radiance) {
    dvec3 out;
    for (int c = 0; c < 3; ++c) out[c] = srgb_slope(std::min(radiance[c], 1.0));
    return out;
}

}  // namespace

double folded_lobe(const LobeHit& h, const dvec3& direction) {
    const double out = glm::dot(direction, h.side);
    if (!(out > 0)) return 0;
    return power(glm::dot(h.axis, direction), h.exponent) +
           power(glm::dot(h.axis, direction - 2 * out * h.side), h.exponent);
}

struct LobeMeans::Ray {
    std::uint32_t hit = 0;               // the hit whose lobe was sampled
    std::uint32_t pixel = 0, index = 0;  // of the sampler
    dvec3 direction{0};
    double density = 0;  // folded_lobe * (exponent + 1)
    dvec3 radiance{0};
    double t = 0;  // distance of the surface that the ray hits, m; infinite if there is none
};

struct LobeMeans::Group {
    std::size_t first = 0, end = 0;
    std::uint64_t seed = 0;
    std::uint32_t sent = 0;
    dvec3 mean{0}, deviation{0};  // of the radiance in the first pass
    std::vector<std::uint32_t> rays;
};

LobeMeans::LobeMeans(const RayScene& scene, const WhittedSettings& settings)
    : sampler_(SamplerKind::random, Sampler::max_spp, 0),
      bound_(radiance_bounds(scene.scene(), settings.max_depth)) {
    for (int left = 1; left < settings.max_depth; ++left) {
        tracers_.emplace_back(
            scene, sampler_,
            DistributedSettings{
                .max_depth = left, .min_contribution = settings.min_contribution, .roulette = true});
    }
}

// Traces `rays` from index `first` on, in batches. The hit to which a ray belongs limits how many surfaces
// the ray may still hit by reflections and refractions (`nodes_left`). All rays of a batch must have the same
// limit. So `rays` must be sorted by the `nodes_left` of their hits.
void LobeMeans::trace(std::span<const LobeHit> hits, std::vector<Ray>& rays, std::size_t first,
                      RayCounts& counts) const {
    thread_local EyeRays eye;
    while (first < rays.size()) {
        const int left = hits[rays[first].hit].nodes_left;
        std::size_t end = first;
        eye.rays.clear(true);
        eye.pixel.clear();
        eye.index.clear();
        eye.importance.clear();
        for (; end < rays.size() && hits[rays[end].hit].nodes_left == left; ++end) {
            const Ray& r = rays[end];
            const LobeHit& h = hits[r.hit];
            eye.rays.add(h.origin + RayScene::offset(h.origin) * h.side, r.direction,
                         std::numeric_limits<float>::infinity(), h.key);
            eye.pixel.push_back(r.pixel);
            eye.index.push_back(static_cast<int>(r.index));
            eye.importance.push_back(largest(h.weight));
        }
        RayCounts spent;
        tracers_[static_cast<std::size_t>(left) - 1].trace(eye, spent);
        counts.reflect += spent.reflect;
        counts.refract += spent.refract;
        counts.shadow += spent.shadow;
        for (std::size_t i = first; i < end; ++i) {
            const std::size_t k = i - first;
            Ray& r = rays[i];
            r.radiance = eye.radiance[k];
            r.t = eye.rays.hit(k).valid() ? static_cast<double>(eye.rays.t[k])
                                          : std::numeric_limits<double>::infinity();
            const NodePath& path = hits[r.hit].path;
            ++(path.bounce(path.depth() - 1) == NodePath::Bounce::reflected ? counts.reflect
                                                                            : counts.refract);
        }
        first = end;
    }
}

void LobeMeans::average(std::span<const LobeHit> hits, std::vector<dvec3>& means, RayCounts& counts) const {
    thread_local std::vector<std::uint32_t> order;
    thread_local std::vector<Ray> rays;
    thread_local std::vector<Group> groups;
    means.assign(hits.size(), dvec3(0));
    order.resize(hits.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto group_of = [&](std::uint32_t i) {
        return std::tuple(hits[i].nodes_left, hits[i].object, hits[i].path.bits());
    };
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::tuple(group_of(a), curve_index(hits[a].at)) <
               std::tuple(group_of(b), curve_index(hits[b].at));
    });
    rays.clear();
    groups.clear();
    const auto send = [&](Group& g, std::uint32_t i) {
        const LobeHit& h = hits[i];
        Ray r;
        r.hit = i;
        r.pixel = high_word(g.seed);
        r.index = g.sent % static_cast<std::uint32_t>(Sampler::max_spp);
        r.direction = spread_direction(h.axis, h.exponent, lobe_point(g.seed, g.sent++));
        const double out = glm::dot(r.direction, h.side);
        if (out < 0) r.direction -= 2 * out * h.side;
        r.density = (h.exponent + 1) * folded_lobe(h, r.direction);
        g.rays.push_back(static_cast<std::uint32_t>(rays.size()));
        rays.push_back(r);
    };

    for (std::size_t first = 0; first < order.size();) {
        Group g;
        g.first = g.end = first;
        while (g.end < order.size() && group_of(order[g.end]) == group_of(order[first])) ++g.end;
        g.seed = seed_of(hits[order[first]]);
        const std::size_t count = g.end - g.first;
        double weight = 0;
        for (std::size_t k = g.first; k < g.end; ++k) weight += largest(hits[order[k]].weight);
        weight *= std::max(1.0, bound_[static_cast<std::size_t>(hits[order[first]].nodes_left)]) /
                  static_cast<double>(count);
        // If `weight` is NaN, std::min returns `count`.
        const auto pilots = static_cast<std::size_t>(
            std::min(static_cast<double>(count), std::ceil(weight / target_noise) + 1));
        for (std::size_t j = 0; j < pilots; ++j) send(g, order[g.first + (2 * j + 1) * count / (2 * pilots)]);
        first = g.end;
        groups.push_back(std::move(g));
    }
    trace(hits, rays, 0, counts);

    const std::size_t pilots = rays.size();
    for (Group& g : groups) {
        dvec3 sum(0), squares(0);
        for (const std::uint32_t r : g.rays) {
            sum += rays[r].radiance;
            squares += rays[r].radiance * rays[r].radiance;
        }
        const auto n = static_cast<double>(g.rays.size());
        g.mean = sum / n;
        g.deviation = n < 2 ? sum : glm::sqrt(glm::max(dvec3(0), squares - sum * sum / n) / (n - 1));
        const double piloted = n / static_cast<double>(g.end - g.first);
        constexpr std::size_t enough = 64;
        const std::size_t stride = std::max<std::size_t>((g.end - g.first) / enough, 1);
        double owed = 0;
        for (std::size_t i = g.first; i < g.end; ++i) {
            const LobeHit& h = hits[order[i]];
            const double relative =
                largest(h.weight * g.deviation * encoded_slope(h.beside + h.weight * g.mean)) / target_noise;
            if (!(relative * relative > piloted)) continue;  // nor if it is NaN
            double within = 0;
            for (std::size_t k = g.first + (i - g.first) % stride; k < g.end; k += stride) {
                const LobeHit& other = hits[order[k]];
                if (const double w = window(h, other); w > 0 && overlap(h, other)) within += w;
            }
            within = std::max(within * static_cast<double>(stride), 1.0);
            owed += std::max(std::min(relative * relative / within, static_cast<double>(most_rays)) - piloted,
                             0.0);
            for (; owed >= 1; owed -= 1) send(g, order[i]);
        }
    }
    trace(hits, rays, pilots, counts);

    for (const Group& g : groups) {
        dvec3 all(0);
        for (const std::uint32_t r : g.rays) all += rays[r].radiance;
        all /= static_cast<double>(g.rays.size());
        for (std::size_t i = g.first; i < g.end; ++i) {
            const LobeHit& h = hits[order[i]];
            dvec3 sum(0);
            double weights = 0;
            for (const std::uint32_t k : g.rays) {
                const Ray& r = rays[k];
                const LobeHit& from = hits[r.hit];
                double weight = window(h, from);
                if (!(weight > 0) || !overlap(h, from)) continue;
                dvec3 direction = r.direction;
                if (r.hit != order[i]) {
                    double nearness = 1;
                    if (std::isfinite(r.t)) {
                        direction = from.origin + r.t * r.direction - h.origin;
                        const double distance = glm::length(direction);
                        if (!(distance > 0)) continue;
                        direction /= distance;
                        nearness = r.t * r.t / (distance * distance);
                    }
                    weight *= std::min((h.exponent + 1) * folded_lobe(h, direction) / r.density * nearness,
                                       most_weight);
                }
                sum += weight * r.radiance;
                weights += weight;
            }
            means[order[i]] = weights > 0 ? sum / weights : all;
        }
    }
}

}  // namespace postlens
