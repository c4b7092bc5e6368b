#include "tracer/recording/cell_split.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace postlens {
namespace {

// Sets a flag of a recorded surface hit. Atomic, because quadtree cells with a common corner share the hit
// and may set the flag at once.
void set_mark(Record& r, std::uint8_t mark) {
    const std::atomic_ref<std::uint8_t> marks(r.mark);
    if ((marks.load(std::memory_order_relaxed) & mark) == 0) marks.fetch_or(mark, std::memory_order_relaxed);
}

}  // namespace

bool CellSplit::has_contrast(double lo, double hi) const {
    return hi > lo && (hi - lo) / (hi + lo + 0.05) > settings_.threshold;
}

bool CellSplit::differ(const CornerCell& c, const Seen* s, int count) const {
    for (int i = 1; i < count; ++i) {
        if (s[i].id != s[0].id) return is_larger(c, settings_.edge_levels);
    }
    for (int i = 1; i < count; ++i) {
        if (s[i].part != s[0].part && is_larger(c, settings_.edge_levels)) return true;
    }
    if (!is_larger(c, settings_.colour_levels)) return false;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        float lo = s[0].rgb[channel], hi = lo;
        for (int i = 1; i < count; ++i) {
            lo = std::min(lo, s[i].rgb[channel]);
            hi = std::max(hi, s[i].rgb[channel]);
        }
        if (has_contrast(lo, hi)) return true;
    }
    return pattern_between(s, count);
}

bool CellSplit::pattern_between(const Seen* s, int count) const {
    if (s[0].chunk->sources.empty()) return false;
    NodeOfEach node;
    for (std::uint32_t n = 0; n < s[0].count; ++n) {
        if (nodes_like(s, count, n, node) &&
            (shadows_differ(s, node, count) || texture_differs(s, node, count)))
            return true;
    }
    return false;
}

void CellSplit::mark_leaf(const CornerCell& c) const {
    // Marks the records of an undivided quadtree cell if the outline of a mesh passes between its corners.
    // Such a cell is normally divided. It can be left undivided only if it has already reached the limit
    // `edge_levels`, i.e. the greatest depth of subdivision at edges. So larger cells need no test.
    const bool ends_edges = !is_larger(c, settings_.edge_levels);
    if (ends_edges && outline_between(c)) {
        for (const std::uint32_t corner : c.corner)
            set_mark(chunks_[samples_[corner].chunk].records[samples_[corner].first], RecordMark::gap);
    }
    const bool parts = tracer_.has_parts() && ends_edges;
    bool textures = tracer_.has_textures() && !is_larger(c, settings_.colour_levels);
    if (textures) {
        // Textures are compared with the nodes of the first corner.
        const CornerSample& first = samples_[c.corner[0]];
        const ColourSource* sources = chunks_[first.chunk].sources.data() + first.first;
        textures = std::any_of(sources, sources + first.count,
                               [](const ColourSource& s) { return s.texture != nullptr; });
    }
    if (!textures && !parts) return;
    std::array<Seen, 4> seen = visible_layers(c);
    const auto mark = [&] {
        if (textures) mark_textures(seen);
        if (parts) mark_parts(seen);
    };
    mark();
    std::array<std::uint32_t, 4> at{};
    for (std::size_t i = 0; i < 4; ++i) at[i] = samples_[c.corner[i]].visible;
    while (std::all_of(at.begin(), at.end(), [&, i = std::size_t{0}](std::uint32_t a) mutable {
        return a < samples_[c.corner[i++]].count;
    })) {
        for (std::size_t i = 0; i < 4; ++i) take_layer(samples_[c.corner[i]], at[i], seen[i]);
        mark();
    }
}

void CellSplit::mark_parts(const std::array<Seen, 4>& s) {
    for (const Seen& other : s) {
        if (other.id != s[0].id) return;
    }
    if (std::all_of(s.begin(), s.end(), [&](const Seen& other) { return other.part == s[0].part; })) return;
    for (const Seen& corner : s) set_mark(corner.chunk->records[corner.first], RecordMark::gap);
}

void CellSplit::mark_textures(const std::array<Seen, 4>& s) const {
    NodeOfEach node;
    for (std::uint32_t n = 0; n < s[0].count; ++n) {
        if (s[0].chunk->sources[s[0].first + n].texture == nullptr) continue;
        if (!nodes_like(s.data(), 4, n, node) || !texture_differs(s.data(), node, 4)) continue;
        for (std::size_t i = 0; i < 4; ++i) set_mark(s[i].chunk->records[node[i]], RecordMark::fine_texture);
    }
}

bool CellSplit::nodes_like(const Seen* s, int count, std::uint32_t n, NodeOfEach& out) {
    out[0] = s[0].first + n;
    for (int i = 1; i < count; ++i) {
        if (n == 0 && s[i].path == s[0].path) {  // the surfaces themselves, without a look at their records
            if (s[i].id != s[0].id) return false;
            out[static_cast<std::size_t>(i)] = s[i].first;
            continue;
        }
        const auto found = node_like(s[0].chunk->records[out[0]], s[i], n);
        if (!found) return false;
        out[static_cast<std::size_t>(i)] = *found;
    }
    return true;
}

std::optional<std::uint32_t> CellSplit::node_of_path(NodePath path, const Seen& in, std::uint32_t guess) {
    const Record* const records = in.chunk->records.data() + in.first;
    if (guess < in.count && records[guess].path == path) return in.first + guess;
    for (std::uint32_t n = 0; n < in.count; ++n) {
        if (records[n].path == path) return in.first + n;
    }
    return std::nullopt;
}

std::optional<std::uint32_t> CellSplit::node_like(const Record& wanted, const Seen& in, std::uint32_t guess) {
    const auto node = node_of_path(wanted.path, in, guess);
    return node && in.chunk->records[*node].id == wanted.id ? node : std::nullopt;
}

bool CellSplit::shadows_differ(const Seen* s, const NodeOfEach& node, int count) {
    for (int i = 1; i < count; ++i) {
        if (s[i].chunk->sources[node[static_cast<std::size_t>(i)]].shadows !=
            s[0].chunk->sources[node[0]].shadows)
            return true;
    }
    return false;
}

bool CellSplit::texture_differs(const Seen* s, const NodeOfEach& node, int count) const {
    const Texture* texture = s[0].chunk->sources[node[0]].texture;
    if (texture == nullptr) return false;
    glm::vec3 low = s[0].chunk->sources[node[0]].place, high = low;
    for (int i = 1; i < count; ++i) {
        const ColourSource& source = s[i].chunk->sources[node[static_cast<std::size_t>(i)]];
        if (source.texture != texture) return false;
        low = glm::min(low, source.place);
        high = glm::max(high, source.place);
    }
    const ColourRange range = texture->range(low, high);
    if (range.low == range.high) return false;
    std::array<glm::dvec3, most_samples> texels;
    for (int i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        texels[k] = texture->colour_at(s[i].chunk->sources[node[k]].place);
    }
    for (int channel = 0; channel < 3; ++channel) {
        // Estimates the radiance between the samples of the quadtree cell, because the texture may have finer
        // details there. In each colour channel, the estimate is a linear function of the texture's colour:
        // times * colour + plus. `times` is the largest ratio of the surface's radiance to its texture colour
        // at the samples, so that contrast is not underestimated. `plus` stands for radiance that does not
        // depend on the texture, such as reflections. It is the least that remains of a sample's radiance
        // without times * colour, and at least 0.
        double times = 0, plus = HUGE_VAL;
        std::array<double, most_samples> texel{};
        for (int i = 0; i < count; ++i) {
            const auto k = static_cast<std::size_t>(i);
            texel[k] = texels[k][channel];
            if (texel[k] > 1e-6)
                times = std::max(
                    times, static_cast<double>(steady_radiance(*s[i].chunk, node[k])[channel]) / texel[k]);
        }
        for (int i = 0; i < count; ++i) {
            const auto k = static_cast<std::size_t>(i);
            plus = std::min(
                plus, static_cast<double>(s[i].rgb[static_cast<std::size_t>(channel)]) - times * texel[k]);
        }
        plus = std::max(plus, 0.0);
        if (has_contrast(plus + times * range.low[channel], plus + times * range.high[channel])) return true;
    }
    return false;
}

void CellSplit::take_layer(const CornerSample& s, std::uint32_t& at, Seen& out) const {
    TracedSamples& chunk = chunks_[s.chunk];
    const Record* r = chunk.records.data() + s.first;
    const std::uint32_t layer = r[at].layer;
    out.id = r[at].id;
    out.part = chunk.sources.empty() ? 0 : chunk.sources[s.first + at].part;
    out.path = r[at].path;
    out.rgb = {};
    out.chunk = &chunk;
    out.first = s.first + at;
    out.count = 0;
    for (; at < s.count && r[at].layer == layer; ++at) {
        const glm::vec3 c = steady_radiance(chunk, s.first + at);
        out.rgb[0] += c.r;
        out.rgb[1] += c.g;
        out.rgb[2] += c.b;
        ++out.count;
    }
}

bool CellSplit::splits(const CornerCell& c) const {
    const std::array<Seen, 4> seen = visible_layers(c);
    const bool hidden = std::any_of(c.corner.begin(), c.corner.end(), [&](std::uint32_t corner) {
        return samples_[corner].count > samples_[corner].visible;
    });
    return differ(c, seen.data(), 4) || (hidden && hidden_layers_differ(c)) ||
           (!things_.empty() && small_things_ask(c, hidden)) ||
           (is_larger(c, settings_.edge_levels) && outline_between(c)) ||
           (!things_.images().empty() && bright_images_ask(c, seen));
}

bool CellSplit::centre_differs(const CornerCell& c, std::uint32_t centre) const {
    const auto [a, b, d, e] = c.corner;
    const std::array<Seen, most_samples> seen{visible_layer(a), visible_layer(b), visible_layer(d),
                                              visible_layer(e), visible_layer(centre)};
    return differ(c, seen.data(), most_samples);
}

bool CellSplit::small_things_ask(const CornerCell& c, bool hidden) const {
    float farthest = 0;
    bool edge = false;
    for (const std::uint32_t corner : c.corner) {
        const CornerSample& s = samples_[corner];
        farthest = std::max(farthest, s.z);
        edge = edge || s.id != samples_[c.corner[0]].id;
    }
    const glm::dvec2 at = grid_.position(CornerGrid::key(c.x, c.y));
    const double size = static_cast<double>(c.size) / grid_.unit;
    const WantedCells wanted = things_.wanted(
        at.x, at.y, size, hidden ? std::numeric_limits<double>::infinity() : static_cast<double>(farthest));
    return wanted.divide(size, edge);
}

bool CellSplit::outline_between(const CornerCell& c) const {
    if (things_.outlines().empty()) return false;
    const CornerSample& first = samples_[c.corner[0]];
    MeshOutlines::Shown shown{first.id, first.part, {}};
    for (std::size_t i = 0; i < 4; ++i) {
        const CornerSample& s = samples_[c.corner[i]];
        if (s.id != first.id || s.part != first.part) return false;
        shown.z_m[i] = s.z;
    }
    const glm::dvec2 at = grid_.position(CornerGrid::key(c.x, c.y));
    return things_.outlines().cross(at.x, at.y, static_cast<double>(c.size) / grid_.unit, shown);
}

bool CellSplit::bright_images_ask(const CornerCell& c, const std::array<Seen, 4>& s) const {
    const double size = static_cast<double>(c.size) / grid_.unit;
    for (std::uint32_t n = 0; n < s[0].count; ++n) {
        const Record& first = s[0].chunk->records[s[0].first + n];
        if (first.path.bits() == 0) continue;
        std::array<const Arrival*, 4> at{};
        bool edge = false;
        for (std::size_t i = 0; i < 4; ++i) {
            const auto node = node_of_path(first.path, s[i], n);
            if (!node) break;
            at[i] = &s[i].chunk->arrivals[*node];
            edge = edge || s[i].chunk->records[*node].id != first.id;
        }
        const bool alike = std::all_of(at.begin(), at.end(), [&](const Arrival* a) {
            return a != nullptr && a->parent == at[0]->parent;
        });
        if (alike && things_.images().wanted(at, size).divide(size, edge)) return true;
    }
    return false;
}

bool CellSplit::hidden_layers_differ(const CornerCell& c) const {
    std::array<std::uint32_t, 4> at{};
    constexpr std::uint32_t none = 0xFFFFFFFFU;
    std::array<std::uint32_t, 4> paths{};
    for (std::size_t i = 0; i < 4; ++i) {
        at[i] = samples_[c.corner[i]].visible;
        paths[i] = next_path(c.corner[i], at[i], none);
    }
    std::array<Seen, 4> seen;
    for (;;) {
        const std::uint32_t path = *std::min_element(paths.begin(), paths.end());
        if (path == none) return false;
        int count = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            if (paths[i] != path) continue;
            take_layer(samples_[c.corner[i]], at[i], seen[static_cast<std::size_t>(count++)]);
            paths[i] = next_path(c.corner[i], at[i], none);
        }
        if (differ(c, seen.data(), count)) return true;
    }
}

std::uint32_t CellSplit::next_path(std::uint32_t sample, std::uint32_t at, std::uint32_t none) const {
    const CornerSample& s = samples_[sample];
    return at < s.count ? chunks_[s.chunk].records[s.first + at].path.bits() : none;
}

}  // namespace postlens
