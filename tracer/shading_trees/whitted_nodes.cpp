// Completes the shading trees after tracing. A shading tree contains all surfaces that an eye ray and its
// reflections and refractions hit. Three steps complete it:
// - The mean radiances that glossy surfaces reflect, and those that area lights cause, are added.
// - `w_bend` is measured, i.e. how nonlinearly the image of a mirrored or refracted surface moves when the
//   lens point moves.
// - The surface hits are converted to records for the sample file.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/resize_to_overwrite.h"
#include "tracer/shading_trees/bend_around.h"
#include "tracer/shading_trees/whitted_impl.h"

namespace postlens {
namespace {

using glm::dvec3;

}  // namespace

void WhittedTracer::Impl::average_lobes(Workspace& w, RayCounts& counts) const {
    for (std::size_t i = 0; i < w.lobes.size(); ++i)
        w.lobes[i].beside = w.lobe_targets[i].throughput * w.nodes[w.lobe_targets[i].node].radiance;
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

void WhittedTracer::Impl::collect(Workspace& w, TracedSamples& out) const {
    out.offsets.assign(w.positions.size() + 1, 0);
    for (std::size_t i = 0; i < w.nodes.count; ++i) ++out.offsets[w.nodes[i].sample + 1];
    for (std::size_t i = 1; i < out.offsets.size(); ++i) out.offsets[i] += out.offsets[i - 1];
    resize_to_overwrite(out.records, w.nodes.count);
    const bool with_noisy = noisy(), only_records = !with_noisy && !has_sources && !has_arrivals;
    resize_to_overwrite(out.noisy, with_noisy ? w.nodes.count : 0);
    resize_to_overwrite(out.sources, has_sources ? w.nodes.count : 0);
    resize_to_overwrite(out.arrivals, has_arrivals ? w.nodes.count : 0);
    std::vector<std::uint32_t>& next = w.order;
    next.assign(out.offsets.begin(), out.offsets.end() - 1);
    for (std::size_t i = 0; i < w.nodes.count; ++i) {
        const Node& n = w.nodes[i];
        const dvec3 c = n.radiance * n.throughput;
        const std::uint32_t at = next[n.sample]++;
        // Copies the whole record first, and then sets fields of the copy. The opposite order would be
        // slower: a processor copies a record by a few wide reads, and such a read must wait until preceding
        // small writes to the same memory are complete.
        Record& r = out.records[at];
        r = n.record;
        r.x = static_cast<float>(w.positions[n.sample].x);
        r.y = static_cast<float>(w.positions[n.sample].y);
        r.r = static_cast<float>(c.x);
        r.g = static_cast<float>(c.y);
        r.b = static_cast<float>(c.z);
        if (with_noisy) out.noisy[at] = glm::vec3(n.noisy * n.throughput);
        if (has_sources) out.sources[at] = n.source;
        if (has_arrivals) out.arrivals[at] = n.arrival;
    }
    const auto before = [](const Record& a, const Record& b) {
        return a.layer != b.layer ? a.layer < b.layer : a.path.bits() < b.path.bits();
    };
    struct All {
        Record record;
        glm::vec3 noisy{0};
        ColourSource source;
        Arrival arrival;
    };
    std::vector<All> all;
    for (std::size_t i = 0; i < w.positions.size(); ++i) {
        const std::size_t begin = out.offsets[i], end = out.offsets[i + 1];
        const auto first = out.records.begin() + static_cast<std::ptrdiff_t>(begin),
                   last = out.records.begin() + static_cast<std::ptrdiff_t>(end);
        if (end - begin <= 2 || std::is_sorted(first, last, before)) continue;
        if (only_records) {
            std::sort(first, last, before);
            continue;
        }
        all.clear();
        for (std::size_t k = begin; k < end; ++k) {
            all.push_back({out.records[k], with_noisy ? out.noisy[k] : glm::vec3(0),
                           has_sources ? out.sources[k] : ColourSource(),
                           has_arrivals ? out.arrivals[k] : Arrival()});
        }
        std::sort(all.begin(), all.end(),
                  [&](const All& a, const All& b) { return before(a.record, b.record); });
        for (std::size_t k = begin; k < end; ++k) {
            out.records[k] = all[k - begin].record;
            if (with_noisy) out.noisy[k] = all[k - begin].noisy;
            if (has_sources) out.sources[k] = all[k - begin].source;
            if (has_arrivals) out.arrivals[k] = all[k - begin].arrival;
        }
    }
}

}  // namespace postlens
