#include "reproject/sheets/sample_surfaces.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

/// Two neighbouring ray hits count as points of one surface only if the line between them has at most this
/// slope against the film (tangent of the angle). Curved surfaces rarely exceed it: a sphere with a radius of
/// 1600 px is steeper only within 0.5 px of its outline.
constexpr double steepest_slope = 40;

/// Combines the records [first, last) of one eye ray into the surface `out`. The first record should be the
/// ray's direct hit. The others are the reflections and refractions seen at this hit. The radiance of `out`
/// is the sum over all of them. Returns false if the direct hit was not recorded.
bool take_surface(const Record* first, const Record* last, LayerSurface& out) {
    const Record& primary = *first;
    const bool known = primary.path.bits() == 0;
    out = {std::isinf(primary.z) ? 0.0F : 1 / primary.z, 0, 0, 0, primary.id};
    double red = 0, green = 0, blue = 0;
    for (const Record* r = first; r != last; ++r) {
        red += static_cast<double>(r->r);
        green += static_cast<double>(r->g);
        blue += static_cast<double>(r->b);
    }
    out.r = static_cast<float>(red);
    out.g = static_cast<float>(green);
    out.b = static_cast<float>(blue);
    return known;
}

}  // namespace

bool is_one_surface(float low_inverse_z, float high_inverse_z, double across, bool perspective) {
    if (high_inverse_z == low_inverse_z) return true;
    // `near` and `far` are the inverse depths of the two hits, in 1/m. The depths differ by 1 / far - 1 /
    // near. For a perspective camera, the distance between the rays at the farther hit is across / far. So
    // the slope is (near - far) / near / across.
    const auto near = static_cast<double>(high_inverse_z), far = static_cast<double>(low_inverse_z);
    if (perspective) return (near - far) / near <= steepest_slope * across;
    return far > 0 && 1 / far - 1 / near <= steepest_slope * across;
}

double across_per_px(const SampleHeader& h) {
    return h.projection == Projection::perspective ? h.pixel_pitch_mm / h.film_distance_mm
                                                   : h.pixel_pitch_mm * 1e-3;
}

namespace {

/// Calls take(visible, first, last) for each surface that an eye ray hits, visible or hidden behind others.
/// The records [first, last) are those of the surface and of its reflections and refractions. `visible` is
/// the first record of the ray's visible surface. Calls done() after each ray.
template <typename Take, typename Done>
void for_each_layer(const RecordBand& band, const PointSamples& points, int y_begin, const Take& take,
                    const Done& done) {
    struct Run {
        std::uint32_t sample = 0;
        const Record *first = nullptr, *last = nullptr;
    };
    thread_local std::vector<Run> hidden;
    const std::size_t pixels = points.offsets.size() - 1;
    const std::size_t first_pixel = band.pixel(band.x_begin, y_begin);
    const Record* records = band.records.data();
    for (std::size_t k = 0; k < pixels; ++k) {
        const std::uint32_t begin = points.offsets[k], end = points.offsets[k + 1];
        // The records of one eye ray may lie at several positions of the pixel's list, because the list is
        // sorted by layer first: 0 for visible surfaces, 1 or more for hidden ones. Within a layer, it is
        // sorted by the raster position of the ray.
        const PointSample& last = points.samples[end - 1];
        const Record* r = records + last.first_record + last.record_count;
        const Record* pixel_end = records + band.offsets[first_pixel + k + 1];
        hidden.clear();
        std::uint32_t at = begin;
        for (std::uint32_t layer = 0; r != pixel_end;) {
            if (r->layer != layer) at = begin;
            layer = r->layer;
            while (at < end && (points.samples[at].y < r->y ||
                                (points.samples[at].y == r->y && points.samples[at].x < r->x)))
                ++at;
            const bool of_sample = at < end && points.samples[at].x == r->x && points.samples[at].y == r->y;
            const Record* first = r;
            while (r != pixel_end && r->layer == layer && r->x == first->x && r->y == first->y) ++r;
            if (of_sample) hidden.push_back({at, first, r});
        }
        std::stable_sort(hidden.begin(), hidden.end(),
                         [](const Run& a, const Run& b) { return a.sample < b.sample; });
        auto next = hidden.cbegin();
        for (std::uint32_t i = begin; i < end; ++i) {
            const PointSample& s = points.samples[i];
            const Record* node = records + s.first_record;
            take(node, node, node + s.record_count);
            for (; next != hidden.cend() && next->sample == i; ++next) take(node, next->first, next->last);
            done();
        }
    }
}

/// Finds one hit among the records [first, last) of an eye ray: the surface that the ray reaches by `path`, a
/// sequence of reflections and transmissions. Returns its record, or null if this surface is not recorded.
/// The records must be sorted by their paths.
const Record* node_at(const Record* first, const Record* last, NodePath path) {
    const Record* found = std::lower_bound(
        first, last, path, [](const Record& r, NodePath p) { return r.path.bits() < p.bits(); });
    return found != last && found->path == path ? found : nullptr;
}

}  // namespace

void find_surfaces(const RecordBand& band, const PointSamples& points, int y_begin, SampleSurfaces& out) {
    out.surfaces.clear();
    out.offsets.assign(1, 0);
    for_each_layer(
        band, points, y_begin,
        [&](const Record*, const Record* first, const Record* last) {
            LayerSurface surface;
            if (take_surface(first, last, surface)) out.surfaces.push_back(surface);
        },
        [&] { out.offsets.push_back(static_cast<std::uint32_t>(out.surfaces.size())); });
}

namespace {

/// For each ray hit in [first, last), finds the mirror or glass in which it is seen, which is called its
/// parent. `parents` gets the parent's index, counted from `first`. If the parent is not recorded, or if a
/// hit is seen directly, the hit gets its own index.
void find_parents(const Record* first, const Record* last, std::vector<std::uint32_t>& parents) {
    const auto count = static_cast<std::uint32_t>(last - first);
    parents.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const Record* parent =
            first[i].path.bits() == 0 ? nullptr : node_at(first, last, first[i].path.parent());
        parents[i] = parent == nullptr ? i : static_cast<std::uint32_t>(parent - first);
    }
}

/// Returns the 2x2 matrix W of a recorded surface point, in 1/m, which tells how far the point's image moves
/// with the lens point. For a point seen directly, W is the unit matrix divided by the depth.
Mat2 w_of(const Record& r) {
    return r.path.bits() == 0 ? Mat2::isotropic(std::isinf(r.z) ? 0.0F : 1 / r.z) : r.w;
}

/// Returns the spectral norm (greater singular value) of a - b.
float departure(const Mat2& a, const Mat2& b) {
    const float xx = a.xx - b.xx, xy = a.xy - b.xy, yx = a.yx - b.yx, yy = a.yy - b.yy;
    return (std::hypot(xx + yy, xy - yx) + std::hypot(xx - yy, xy + yx)) / 2;
}

void find_below(const Record* first, const std::vector<std::uint32_t>& parents, float bright_above,
                std::vector<TreeSurface>& nodes) {
    for (std::uint32_t i = 0; i < parents.size(); ++i) {
        const Record& r = first[i];
        const bool bright = std::max({r.r, r.g, r.b}) > bright_above;
        for (std::uint32_t at = i; parents[at] != at; at = parents[at]) {
            const Record& above = first[parents[at]];
            TreeSurface& node = nodes[parents[at]];
            const auto bounce = static_cast<std::size_t>(first[at].path.kind()) - 1;
            auto& below = node.below[bounce];
            below = {below[0] + r.r, below[1] + r.g, below[2] + r.b};
            node.marks_below[bounce] |= r.mark;
            const float stray = bright ? HUGE_VALF : departure(w_of(r), w_of(above));
            node.strays[bounce] = std::max(node.strays[bounce], std::isnan(stray) ? HUGE_VALF : stray);
        }
    }
}

}  // namespace

void find_trees(const RecordBand& band, const PointSamples& points, int y_begin, float bright_above,
                SampleTrees& primary, SampleTrees& deeper) {
    for (SampleTrees* trees : {&primary, &deeper}) {
        trees->nodes.clear();
        trees->offsets.assign(1, 0);
        trees->any_below = false;
    }
    // Reserves all memory of the lists `primary.nodes` and `deeper.nodes` at once. If they grew step by step,
    // each step would need memory for the old and the new list at the same time.
    const std::size_t first_pixel = band.pixel(band.x_begin, y_begin);
    const std::size_t most =
        band.offsets[first_pixel + points.offsets.size() - 1] - band.offsets[first_pixel];
    primary.nodes.reserve(most);
    deeper.nodes.reserve(most);
    std::vector<std::uint32_t> parents;
    std::vector<TreeSurface> nodes;
    const auto surface = [](const Record& r) {
        TreeSurface s;
        s.inverse_z = std::isinf(r.z) ? 0.0F : 1 / r.z;
        s.rgb = {r.r, r.g, r.b};
        s.id = r.id;
        s.path = r.path;
        s.w = r.w;
        s.bend = r.w_bend;
        s.mark = r.mark;
        return s;
    };
    for_each_layer(
        band, points, y_begin,
        [&](const Record* visible, const Record* first, const Record* last) {
            const bool own_tree = first->path.bits() == 0;
            if (own_tree && last == first + 1) {  // by far the most frequent case
                primary.nodes.push_back(surface(*first));
                return;
            }
            find_parents(first, last, parents);
            nodes.clear();
            for (const Record* r = first; r != last; ++r) nodes.push_back(surface(*r));
            for (std::uint32_t i = 0; i < parents.size(); ++i) {
                if (parents[i] != i) nodes[parents[i]].children |= child_bit(first[i].path.kind());
            }
            find_below(first, parents, bright_above, nodes);
            for (std::uint32_t i = 0; i < parents.size(); ++i) {
                const Record& r = first[i];
                TreeSurface& s = nodes[i];
                SampleTrees& trees = r.path.bits() == 0 ? primary : deeper;
                if (s.children != 0) trees.any_below = true;
                if (r.path.bits() == 0) {
                    primary.nodes.push_back(s);
                    continue;
                }
                const Record* seen_in = parents[i] != i ? first + parents[i] : nullptr;
                if (seen_in == nullptr && !own_tree) {
                    // `seen_in`, the mirror or glass in which this surface is seen, may be recorded with the
                    // ray's visible surface. The records of the visible surface begin at `visible`. They end
                    // at the first record of another ray or of a hidden layer.
                    const Record* end = visible;
                    while (end != first && end->layer == 0 && end->x == first->x && end->y == first->y) ++end;
                    seen_in = node_at(visible, end, r.path.parent());
                }
                if (seen_in == nullptr) continue;
                s.parent_id = seen_in->id;
                deeper.nodes.push_back(s);
            }
        },
        [&] {
            for (SampleTrees* trees : {&primary, &deeper})
                trees->offsets.push_back(static_cast<std::uint32_t>(trees->nodes.size()));
        });
}

}  // namespace postlens
