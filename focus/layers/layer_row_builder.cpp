#include "focus/layers/layer_row_builder.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace postlens {
namespace {

/// Two limits of the CoC radius, in px. The centre of a blur disc is rounded to a quarter pixel above the
/// first limit, and to a whole pixel above the second. More samples can then share a blur kernel.
constexpr double quarter_steps_from_px = 3, whole_steps_from_px = 12;
/// Two radii, in px, that are passed to NodeResponses::phases instead of a disc's true radius. This function
/// rounds the centre of a blur disc, and more coarsely for larger discs. With the first radius, it rounds to
/// quarter pixels, and with the second, to whole pixels.
constexpr double quarter_steps_radius_px = 17, whole_steps_radius_px = 257;

constexpr double tiny_px = 1.0 / (2 * KernelKey::phase_steps);

double mean_w_per_m(const Record& node) {
    return (static_cast<double>(node.w.xx) + static_cast<double>(node.w.yy)) / 2;
}

double signed_radius_px(const FocusGeometry& geometry, double inverse_depth_per_m) {
    constexpr double most = DepthLevels::largest_radius_px;
    return std::clamp(geometry.coc_diameter_px(inverse_depth_per_m) / 2, -most, most);
}

/// Returns the factor that converts the position at which light arrives, in px, to its lens point, in lens
/// radii. It is a least-squares estimate: covariance / variance.
///
/// Light through the point q of the unit disc arrives at R q + S |q|^2 q, with R = CoC radius and S =
/// spherical aberration. Along each axis:
/// - covariance of position and q: R / 4 + S / 6
/// - variance of the position: R^2 / 4 + R S / 3 + S^2 / 8 + 1 / 12 (1 / 12 for the extent of a pixel)
double lens_radii_per_px(const FocusGeometry& geometry, double inverse_depth_per_m, double spherical_px) {
    const double r = signed_radius_px(geometry, inverse_depth_per_m), s = spherical_px;
    return (r + 2 * s / 3) / (r * r + 4 * r * s / 3 + s * s / 2 + 1.0 / 3);
}

}  // namespace

std::uint32_t LayerSplats::RowBuilder::number_of(const LayerPart& part) {
    if (last_number_ != ~std::uint32_t{0} && part == last_part_) return last_number_;
    const auto [entry, is_new] = number_.try_emplace(part, static_cast<std::uint32_t>(row_.parts.size()));
    if (is_new) row_.parts.push_back(part);
    last_part_ = part;
    return last_number_ = entry->second;
}

void LayerSplats::RowBuilder::place(const PointSample& s, const NodeResponse& response,
                                    const std::array<float, 3>& rgb, float weight, double inverse_depth,
                                    const LayerPart& part) {
    const std::uint32_t number = number_of(part);
    const double spherical_px = t_.responses_.model().spherical_px();
    NodeResponse coarser = response;
    // Rounds the centres of large blur discs more coarsely, so that more samples of the pixel share a kernel.
    // This is done only for uniform discs (is_even()), because other kernels may have a bright core, which
    // would visibly move.
    if (!alone_ && t_.responses_.model().is_even() && response.radius_px >= quarter_steps_from_px)
        coarser.radius_px =
            std::max(response.radius_px, response.radius_px >= whole_steps_from_px ? whole_steps_radius_px
                                                                                   : quarter_steps_radius_px);
    const Phases phases = t_.responses_.phases(s, coarser);
    const auto lens_per_px =
        static_cast<float>(lens_radii_per_px(t_.geometry(), inverse_depth, spherical_px));
    for (std::size_t i = 0; i < phases.count; ++i) {
        const Phase& p = phases.items[i];
        KernelKey key = response.key;
        constexpr std::int32_t middle = KernelKey::phase_steps / 2;
        const bool tiny = response.radius_px < tiny_px;
        key.phase_x = tiny ? middle * ((p.x > 0) - (p.x < 0)) : p.x;
        key.phase_y = tiny ? middle * ((p.y > 0) - (p.y < 0)) : p.y;
        const float w = weight * p.weight;
        add({static_cast<std::int32_t>(std::floor(s.x)), y_, cache_.number_of(key), rgb[0] * p.weight,
             rgb[1] * p.weight, rgb[2] * p.weight, w,
             static_cast<float>(static_cast<double>(w) * inverse_depth), lens_per_px, w * covered_},
            number, alone_ ? 0 : KernelKey::PackedHash()(key.packed()));
    }
}

// Adds a sample to the row. If an earlier sample has the same pixel, surface (`number`) and blur kernel, the
// two are merged. `hash` selects the slot of a small hash table in which the earlier sample is looked up, and
// so decides which samples are merged. It must not depend on the timing of threads, so that the image is
// bit-identical in every run.
void LayerSplats::RowBuilder::add(const LayerSplat& splat, std::uint32_t number, std::size_t hash) {
    if (!alone_) {
        const std::uint64_t key = std::uint64_t{number} << 32 | splat.kernel;
        // Each slot of the hash table holds one sample. If it holds a sample with another kernel or surface,
        // the new sample is not merged, which is also correct but slower.
        Slot& slot = slots_[((hash + number) * 0x9E3779B97F4A7C15U) >> 54];
        if (slot.index >= pixel_begin_ && slot.index < row_.splats.size() && slot.key == key) {
            LayerSplat& to = row_.splats[slot.index];
            to.r += splat.r;
            to.g += splat.g;
            to.b += splat.b;
            to.weight += splat.weight;
            to.depth += splat.depth;
            to.covered += splat.covered;
            return;
        }
        slot = {key, row_.splats.size()};
    }
    row_.part.push_back(number);
    row_.splats.push_back(splat);
}

void LayerSplats::RowBuilder::add_node(const PointSample& s, const NodeResponse& response, const Record& node,
                                       const std::array<float, 3>& rgb, const LayerPart& part) {
    const NodeResponses& responses = t_.responses_;
    const float share = responses.passing(response, place_px_);
    const std::array<float, 3> light{share * rgb[0], share * rgb[1], share * rgb[2]};
    place(s, response, light, share, inverse_depth_per_m(node), part);
}

void LayerSplats::RowBuilder::meet(std::span<const Record> nodes, const NodeResponse& primary) {
    met_.clear();
    for (const Record& node : nodes) {
        const bool is_primary = node.path == NodePath();
        met_.push_back({&node,
                        is_primary ? primary : t_.responses_.of(node, primary, place_px_),
                        {node.r, node.g, node.b}});
    }
    // Adds the radiance of each reflected or transmitted surface point to its parent, the mirror or glass
    // that shows it. A parent precedes its points in the list, so the list is traversed backwards. Each point
    // is then complete before it is added.
    for (std::size_t i = met_.size(); i-- > 0;) {
        if (met_[i].node->path == NodePath()) continue;
        for (Met& parent : met_) {
            if (parent.node->path != met_[i].node->path.parent()) continue;
            for (std::size_t c = 0; c < 3; ++c) parent.subtree[c] += met_[i].subtree[c];
        }
    }
}

const LayerSplats::RowBuilder::Met* LayerSplats::RowBuilder::met_at(NodePath path) const {
    const auto found =
        std::find_if(met_.begin(), met_.end(), [path](const Met& m) { return m.node->path == path; });
    return found == met_.end() ? nullptr : &*found;
}

// Returns the surface point whose blur is used for light that arrives through the surface point `from`. This
// is `from` itself, unless it lies on the far side of a glass object. Then it is the point on the near side,
// where the object's visible outline lies, because refraction can make the blur of the far side far too
// large.
const LayerSplats::RowBuilder::Met& LayerSplats::RowBuilder::outline_of(const Met& from) const {
    const Met* met = &from;
    while (met->node->path != NodePath() && met->node->path.kind() == NodePath::Bounce::transmitted) {
        const Met* before = met_at(met->node->path.parent());
        if (before == nullptr || before->node->id != met->node->id) break;
        met = before;
    }
    return *met;
}

void LayerSplats::RowBuilder::add_mask(const PointSample& s, const Met& from, const Met& met) {
    LayerPart part = from.part;
    part.path = met.node->path.bits();
    part.kind = part.kind == LayerPart::Kind::hidden ? LayerPart::Kind::hidden_mask : LayerPart::Kind::mask;
    const Met& outline = outline_of(from);
    if (&outline != &from) {
        part.shown = {};
        part.kind = LayerPart::Kind::outer_mask;
    }
    add_node(s, outline.response, *outline.node, met.subtree, part);
}

void LayerSplats::RowBuilder::add_tree(const PointSample& s, std::span<const Record> nodes,
                                       LayerPart::Kind kind) {
    const Record& first = nodes[0];
    const SurfaceKey surface{first.id,
                             static_cast<std::uint32_t>(std::count(ids_.begin(), ids_.end(), first.id))};
    ids_.push_back(first.id);
    const double inverse_depth = inverse_depth_per_m(first);
    const double radius_px = signed_radius_px(t_.geometry(), inverse_depth);
    double apart = 1;
    for (const double before : radii_px_) apart = std::min(apart, std::abs(radius_px - before));
    radii_px_.push_back(radius_px);
    covered_ = 0;
    const NodeResponse primary = t_.responses_.to_depth(inverse_depth, place_px_);
    if (kind == LayerPart::Kind::seen) {
        // largest_coc_px() reports the largest CoC of the directly visible surfaces at a finite depth. Empty
        // space, at an inverse depth of 0, is no surface.
        if (inverse_depth > 0)
            row_.largest_radius_px = std::max(row_.largest_radius_px, primary.exact_radius_px);
        t_.border_.note(t_.source_, s, y_, primary.farthest_px);
    }
    if (!(s.total_weight() > 0)) return;
    LayerPart part{.surface = surface, .kind = kind};
    if (kind == LayerPart::Kind::hidden) covered_ = static_cast<float>(1 - apart);
    add_node(s, primary, first, {first.r, first.g, first.b}, part);
    covered_ = 0;
    if (nodes.size() == 1) {
        row_.colours.include({first.r, first.g, first.b});
        return;
    }
    meet(nodes, primary);
    row_.colours.include(met_.front().subtree);
    met_.front().part = part;
    for (Met& met : met_) {
        const Record& node = *met.node;
        if (node.path == NodePath()) continue;
        NodePath parent = node.path.parent();
        const Met* from = met_at(parent);
        while (from == nullptr) from = met_at(parent = parent.parent());
        add_mask(s, *from, met);
        met.part = {surface, node.path.bits(), {node.id, 0}, LayerPart::Kind::seen};
        add_node(s, met.response, node, {node.r, node.g, node.b}, met.part);
        if (kind == LayerPart::Kind::seen)
            shown_.push_back(
                {node.path.bits(), node.id, signed_radius_px(t_.geometry(), mean_w_per_m(node))});
    }
}

// Adds surfaces that are hidden from the pinhole, but that other lens points see in a mirror or through
// glass.
// - `nodes`: surface points on one ray: first the hidden surface, then what it reflects and transmits
// - `primary`: blur of the mirror or glass
// - `surface`: identifies the mirror or glass
void LayerSplats::RowBuilder::add_hidden_chains(const PointSample& s, std::span<const Record> nodes,
                                                const NodeResponse& primary, SurfaceKey surface) {
    meet(nodes, primary);
    for (Met& met : met_) {
        const Record& node = *met.node;
        Shown now{node.path.bits(), node.id, signed_radius_px(t_.geometry(), mean_w_per_m(node))};
        std::uint32_t before = 0;
        double apart = 1;
        for (const Shown& other : shown_) {
            if (other.path != now.path) continue;
            before += other.id == now.id ? 1 : 0;
            apart = std::min(apart, std::abs(now.radius_px - other.radius_px));
        }
        const Met* from = met_at(node.path.parent());
        met.part = {surface, node.path.bits(), {node.id, before}, LayerPart::Kind::hidden};
        if (from != nullptr) {
            add_mask(s, *from, met);
            met.part = {surface, node.path.bits(), {node.id, 0}, LayerPart::Kind::seen};
        } else {
            shown_.push_back(now);
            covered_ = static_cast<float>(1 - apart);
        }
        add_node(s, met.response, node, {node.r, node.g, node.b}, met.part);
        covered_ = 0;
        row_.colours.include({node.r, node.g, node.b});
    }
}

void LayerSplats::RowBuilder::add_sample(const PointSample& s, std::span<const Record> nodes,
                                         std::span<const Nodes> hidden) {
    place_px_ = from_middle_px(t_.picture_, s.x, s.y);
    ids_.clear();
    radii_px_.clear();
    shown_.clear();
    add_tree(s, nodes, LayerPart::Kind::seen);
    if (!(s.total_weight() > 0)) return;
    for (const Nodes& behind : hidden) {
        if (behind.records[0].path == NodePath()) {
            add_tree(s, behind.records, LayerPart::Kind::hidden);
        } else {
            add_hidden_chains(s, behind.records,
                              t_.responses_.to_depth(inverse_depth_per_m(nodes[0]), place_px_),
                              {nodes[0].id, 0});
        }
    }
}

void LayerSplats::RowBuilder::find_hidden(const RecordBand& band, std::size_t pixel) {
    hidden_.clear();
    const Record* end = band.records.data() + band.offsets[pixel + 1];
    const Record* at = band.records.data() + band.offsets[pixel];
    at = std::partition_point(at, end, [](const Record& r) { return r.layer == 0; });
    while (at != end) {
        const Record* next = at + 1;
        while (next != end && next->layer == at->layer && next->x == at->x && next->y == at->y) ++next;
        hidden_.push_back({at->x, at->y, {at, next}});
        at = next;
    }
    std::stable_sort(hidden_.begin(), hidden_.end(),
                     [](const Nodes& a, const Nodes& b) { return std::tie(a.y, a.x) < std::tie(b.y, b.x); });
}

void LayerSplats::RowBuilder::begin_row(int y) {
    y_ = y;
    row_.clear();
    number_.clear();
    last_number_ = ~std::uint32_t{0};
    std::fill(slots_.begin(), slots_.end(), Slot{0, ~std::size_t{0}});
}

void LayerSplats::RowBuilder::end_row() {
    t_.store(y_, row_);
}

void LayerSplats::RowBuilder::add_light(const PixelLight& light) {
    const PointSample s = middle_of_pixel(light.x, y_);
    place_px_ = from_middle_px(t_.picture_, s.x, s.y);
    const NodeResponses& responses = t_.responses_;
    const NodeResponse response = responses.to_depth(light.spread_depth, place_px_);
    const RasterWindow& known = t_.known_;
    if (!light.hidden && light.x >= known.x_begin && light.x < known.x_end - 1 && y_ >= known.y_begin &&
        y_ < known.y_end - 1) {
        if (light.inverse_depth > 0)
            row_.largest_radius_px = std::max(row_.largest_radius_px, response.exact_radius_px);
        t_.border_.note_pixel(known, light.x, y_, response.farthest_px);
    }
    const LayerPart part{.surface = {light.surface, 0},
                         .kind = light.hidden ? LayerPart::Kind::hidden : LayerPart::Kind::seen};
    covered_ = light.weight > 0 ? light.covered / light.weight : 0;
    if (light.weight > 0) {
        row_.colours.include(
            {light.rgb[0] / light.weight, light.rgb[1] / light.weight, light.rgb[2] / light.weight});
    }
    const float share = responses.passing(response, place_px_);
    const std::array<float, 3> rgb{share * light.rgb[0], share * light.rgb[1], share * light.rgb[2]};
    place(s, response, rgb, share * light.weight, light.inverse_depth, part);
    covered_ = 0;
}

void LayerSplats::RowBuilder::build(std::span<const PixelLight> lights, int y) {
    begin_row(y);
    alone_ = true;
    for (const PixelLight& light : lights) add_light(light);
    end_row();
}

void LayerSplats::RowBuilder::build(const RecordBand& band, const PointSamples& samples,
                                    std::size_t first_pixel, int y) {
    begin_row(y);
    const std::size_t band_pixel = band.pixel(band.x_begin, y);
    for (std::size_t k = 0; k < static_cast<std::size_t>(band.width()); ++k) {
        find_hidden(band, band_pixel + k);
        std::size_t h = 0;
        const std::uint32_t begin = samples.offsets[first_pixel + k],
                            end = samples.offsets[first_pixel + k + 1];
        alone_ = end - begin == 1;
        pixel_begin_ = row_.splats.size();
        for (std::uint32_t i = begin; i < end; ++i) {
            const PointSample& s = samples.samples[i];
            while (h < hidden_.size() && std::tie(hidden_[h].y, hidden_[h].x) < std::tie(s.y, s.x)) ++h;
            std::size_t last = h;
            while (last < hidden_.size() && hidden_[last].x == s.x && hidden_[last].y == s.y) ++last;
            add_sample(s, std::span(band.records).subspan(s.first_record, s.record_count),
                       std::span(hidden_).subspan(h, last - h));
        }
    }
    end_row();
}

}  // namespace postlens
