#include "tracer/shading_trees/lens_reach.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <functional>
#include <limits>

#include "core/threads.h"
#include "tracer/shading_trees/whitted.h"

namespace postlens {
namespace {

constexpr int tile = 16;

/// Returns the hint for a search for depth edges: the square of pixels that is tested first. `pyramid` stores
/// the inverse depths of the visible surfaces. The hint is the square in which this thread's last search for
/// a similar inverse depth, 1/m, at a similar column `x`, px, ended. The next such search often ends there,
/// too.
MinMaxPyramid::Hint& hint_of(const MinMaxPyramid& pyramid, double inverse_depth, double x) {
    thread_local std::array<MinMaxPyramid::Hint, 1024> hints;
    const std::size_t depth =
        std::bit_cast<std::uint64_t>(inverse_depth) >> 49U;  // sign, exponent and three bits of the fraction
    const auto columns = static_cast<std::size_t>(static_cast<std::int64_t>(x) / 32);
    return hints[(std::hash<const void*>()(&pyramid) / alignof(std::max_align_t) + depth + 37 * columns) %
                 hints.size()];
}

WhittedSettings settings_for(int max_depth, double aperture_radius_m) {
    return {.max_depth = std::min(max_depth, LensReach::most_bounces + 1),
            .min_contribution = 0,
            .lens_radius_m = aperture_radius_m,
            .lit = false};
}

/// Sets `z` to the depths, m, of the first surfaces that the eye rays through `positions` hit.
void depths_of_eye_rays(const RayScene& scene, const CameraModel& camera,
                        std::span<const glm::dvec2> positions, std::vector<float>& z) {
    thread_local std::vector<CameraRay> eye;
    thread_local RayBatch batch;
    eye.clear();
    batch.clear(false);
    for (const glm::dvec2& at : positions) {
        eye.push_back(camera.ray(at.x, at.y));
        batch.add(eye.back().origin, eye.back().direction, std::numeric_limits<float>::infinity());
    }
    scene.intersect(batch, true);
    z.clear();
    for (std::size_t k = 0; k < positions.size(); ++k) {
        const HitKey key = batch.hit(k);
        const double t =
            key.valid()
                ? scene.texture_point(key, eye[k].origin, eye[k].direction, static_cast<double>(batch.t[k])).t
                : std::numeric_limits<double>::infinity();
        z.push_back(static_cast<float>(t * eye[k].cos_axis));
    }
}

}  // namespace

LensReach::LensReach(const RayScene& scene, const CameraModel& camera, double aperture_radius_m,
                     int max_depth, double same_place_px, int x_begin, int x_end, int y_begin, int y_end)
    : aperture_radius_m_(aperture_radius_m),
      same_place_px_(same_place_px),
      px_per_inverse_m_(aperture_radius_m / camera.tangent_per_px) {
    const WhittedTracer tracer(scene, camera, settings_for(max_depth, aperture_radius_m));
    const int width = x_end - x_begin, height = y_end - y_begin;
    const int tiles_across = (width + tile - 1) / tile, tiles_down = (height + tile - 1) / tile;
    std::vector<float> visible(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    std::vector<std::vector<Seen>> chains(static_cast<std::size_t>(tiles_across * tiles_down));
    parallel_for(chains.size(), [&](std::size_t i) {
        const int left = x_begin + static_cast<int>(i) % tiles_across * tile,
                  top = y_begin + static_cast<int>(i) / tiles_across * tile;
        thread_local std::vector<glm::dvec2> positions;
        thread_local TracedSamples traced;
        thread_local std::vector<float> z;
        positions.clear();
        // Each packet of 16 rays is a block of 4 x 4 pixels, so its rays are coherent.
        for (int block = 0; block < tile * tile / 16; ++block) {
            for (int k = 0; k < 16; ++k) {
                const int x = left + block % 4 * 4 + k % 4, y = top + block / 4 * 4 + k / 4;
                if (x < x_end && y < y_end) positions.emplace_back(x, y);
            }
        }
        if (tracer.has_deeper_nodes()) {
            RayCounts counts;
            tracer.trace(positions, traced, counts);
        } else {
            depths_of_eye_rays(scene, camera, positions, z);
        }
        for (std::size_t k = 0; k < positions.size(); ++k) {
            const int x = static_cast<int>(positions[k].x), y = static_cast<int>(positions[k].y);
            float& inverse_depth =
                visible[static_cast<std::size_t>(y - y_begin) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x - x_begin)];
            if (!tracer.has_deeper_nodes()) {
                inverse_depth = 1 / z[k];
                continue;
            }
            const auto records = std::span(traced.records)
                                     .subspan(traced.offsets[k], traced.offsets[k + 1] - traced.offsets[k]);
            inverse_depth = 1 / records.front().z;
            add_chains(records, x, y, chains[i]);
        }
    });
    eye_view_ =
        &views_.emplace(View{0, 0}, MinMaxPyramid(x_begin, y_begin, width, height, visible)).first->second;
    std::vector<Seen> all;
    for (std::vector<Seen>& of : chains) all.insert(all.end(), of.begin(), of.end());
    std::stable_sort(all.begin(), all.end(), [](const Seen& a, const Seen& b) { return a.view < b.view; });
    for (auto first = all.begin(); first != all.end();) {
        const auto last =
            std::find_if(first, all.end(), [&](const Seen& s) { return s.view != first->view; });
        add_view(first->view, {first, last});
        first = last;
    }
}

void LensReach::add_chains(std::span<const Record> records, int x, int y, std::vector<Seen>& out) {
    for (const Record& r : records.subspan(1)) {
        const auto parent = std::find_if(records.begin(), records.end(),
                                         [&](const Record& p) { return p.path == r.path.parent(); });
        out.push_back({{r.path.bits(), parent->id}, x, y, static_cast<float>(inverse_depth(r.w))});
    }
}

void LensReach::add_view(const View& view, std::span<const Seen> seen) {
    int x_begin = seen.front().x, x_end = x_begin + 1, y_begin = seen.front().y, y_end = y_begin + 1;
    for (const Seen& s : seen) {
        x_begin = std::min(x_begin, s.x);
        x_end = std::max(x_end, s.x + 1);
        y_begin = std::min(y_begin, s.y);
        y_end = std::max(y_end, s.y + 1);
    }
    const auto width = static_cast<std::size_t>(x_end - x_begin);
    std::vector<float> values(width * static_cast<std::size_t>(y_end - y_begin),
                              std::numeric_limits<float>::quiet_NaN());
    for (const Seen& s : seen) {
        values[static_cast<std::size_t>(s.y - y_begin) * width + static_cast<std::size_t>(s.x - x_begin)] =
            s.inverse_depth;
    }
    views_.emplace(view, MinMaxPyramid(x_begin, y_begin, x_end - x_begin, y_end - y_begin, values));
}

bool LensReach::may_see(const Covers& covers, double behind) const {
    return looks_behind(covers, behind, &MinMaxPyramid::any_in, &MinMaxPyramid::hint_in);
}

bool LensReach::may_see_past(const Covers& covers) const {
    return looks_behind(covers, covers.limit, &MinMaxPyramid::maybe_any_in, &MinMaxPyramid::hint_maybe_in);
}

bool LensReach::looks_behind(const Covers& covers, double behind, Search search, Peek peek) const {
    const MinMaxPyramid* view = eye_view_;
    if (covers.path.bits() != 0) {
        const auto found = views_.find({covers.path.bits(), covers.parent});
        if (found == views_.end()) return false;
        view = &found->second;
    }
    const MinMaxPyramid& seen = *view;
    const double k = px_per_inverse_m_, least = same_place_px_ / k;
    if (covers.farthest - std::max(behind, seen.least()) < least) return false;  // the usual case
    MinMaxPyramid::Hint& hint = hint_of(seen, covers.farthest, covers.at.x);
    const auto cone_for = [&](double nearest) {
        const double radius = k * (nearest - behind) + margin_px;
        return MinMaxPyramid::Cone{covers.at, radius, covers.farthest, least, edge_slope / k};
    };
    const auto edge_for = [&](double nearest) { return (seen.*search)(cone_for(nearest), hint); };
    // edge_for(nearest) searches around the ray for an edge of the covers, i.e. of the surfaces in front. The
    // lens may see the hidden surface past this edge. The search radius is the shift between the images of
    // the hidden surface and a surface with the inverse depth `nearest`.
    // It is called with up to three values:
    // - an upper bound of the inverse depths of all surfaces close to the ray, which rejects most rays
    // - the inverse depth of the nearest cover
    // - the inverse depth of a nearer surface beside the covers, which may hide their edge
    // Before this, the edge that the last search found is tested. If the lens sees past it, no search is
    // needed.
    if ((seen.*peek)(cone_for(covers.nearest), hint)) return true;
    const double radius = k * (covers.nearest - behind) + margin_px;
    if (!edge_for(seen.at_most(covers.at, radius, covers.nearest))) return false;
    if (edge_for(covers.nearest)) return true;
    // A nearer surface beside the covers may hide their edge.
    const double nearer = seen.greatest(covers.at, radius, covers.nearest);
    return nearer > covers.nearest && edge_for(nearer);
}

}  // namespace postlens
