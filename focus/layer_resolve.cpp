#include "focus/layer_resolve.h"

#include <algorithm>
#include <vector>

namespace postlens {
namespace {

using Kind = LayerPart::Kind;

/// From this sum of the chain's weights on its picture is taken as it is; below, the stand-in is mixed in.
constexpr double enough_weight = 0.05;

struct Chain {
    std::uint32_t path;
    std::array<double, 3> rgb;
    SurfaceLight mask, hidden_mask, outer_mask;  ///< their colours are the stand-in's
    [[nodiscard]] double masks() const { return mask.alpha + hidden_mask.alpha + outer_mask.alpha; }
};

/// Adds what a chain shows where the surface has it; it comes through the lens as the surface's own light.
void show(SurfaceLight& surface, const SurfaceLight& mask, const std::array<double, 3>& rgb) {
    const double share = surface.alpha > 0 ? mask.alpha / surface.alpha : 0;
    for (std::size_t c = 0; c < 3; ++c) {
        surface.rgb[c] += mask.alpha * rgb[c];
        surface.lens[c].x += share * surface.lens[3].x * rgb[c];
        surface.lens[c].y += share * surface.lens[3].y * rgb[c];
    }
}

SurfaceLight light_of(const LayerTerm* term) {
    if (term == nullptr) return {};
    return {std::max(term->weight, 0.0), term->rgb, term->lens};
}

/// Of the terms of one thing that is seen, hidden or both.
std::optional<Fragment> fragment_of(const LayerTerm* seen, const LayerTerm* hidden) {
    const double weight = (seen != nullptr ? seen->weight : 0.0) + (hidden != nullptr ? hidden->weight : 0.0);
    if (!(weight > smallest_layer_weight)) return std::nullopt;
    const double depth = (seen != nullptr ? seen->depth : 0.0) + (hidden != nullptr ? hidden->depth : 0.0);
    return Fragment{depth / weight, light_of(seen), light_of(hidden),
                    hidden != nullptr ? std::max(hidden->covered, 0.0) : 0.0};
}

/// The things of a chain, or the surface itself, as fragments; `weight` becomes the sum of theirs.
void gather(std::span<const LayerTerm> terms, std::vector<Fragment>& fragments, double& weight) {
    fragments.clear();
    weight = 0;
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const LayerTerm& term = terms[i];
        if (term.part->kind != Kind::seen && term.part->kind != Kind::hidden) continue;
        weight += term.weight;
        const LayerTerm* seen = term.part->kind == Kind::seen ? &term : nullptr;
        const LayerTerm* hidden = seen == nullptr ? &term : nullptr;
        if (seen != nullptr && i + 1 < terms.size() && terms[i + 1].part->kind == Kind::hidden &&
            terms[i + 1].part->shown == term.part->shown) {
            hidden = &terms[++i];
            weight += hidden->weight;
        }
        if (const auto fragment = fragment_of(seen, hidden)) fragments.push_back(*fragment);
    }
}

Chain resolve_chain(std::span<const LayerTerm> terms, std::span<const Chain> longer,
                    const FocusGeometry& geometry) {
    thread_local std::vector<Fragment> fragments;
    const std::uint32_t path = terms[0].part->path;
    Chain out{path, {}, {}, {}, {}};
    for (const LayerTerm& term : terms) {
        if (term.part->kind == Kind::mask) out.mask = light_of(&term);
        if (term.part->kind == Kind::hidden_mask) out.hidden_mask = light_of(&term);
        if (term.part->kind == Kind::outer_mask) out.outer_mask = light_of(&term);
    }
    const double masks = out.masks();
    if (!(masks > smallest_layer_weight)) return out;
    double weight = 0;
    gather(terms, fragments, weight);
    double own = std::clamp(weight / enough_weight, 0.0, 1.0);
    const bool arrives = weight > smallest_layer_weight;
    if (arrives) out.rgb = composite(fragments, geometry);
    // Masks of longer chains are by the responses of what this one shows, or by those of its own masks.
    for (const Chain& next : longer) {
        if (NodePath(next.path).parent() != NodePath(path)) continue;
        const double share =
            std::min((arrives ? next.mask.alpha / weight : 0.0) + next.outer_mask.alpha / masks, 1.0);
        for (std::size_t c = 0; c < 3; ++c) out.rgb[c] += share * next.rgb[c];
        // What this one shows is known without its own nodes.
        if (next.outer_mask.alpha > smallest_layer_weight) own = 1;
    }
    for (std::size_t c = 0; own < 1 && c < 3; ++c) {
        const double stand_in = (out.mask.rgb[c] + out.hidden_mask.rgb[c] + out.outer_mask.rgb[c]) / masks;
        out.rgb[c] = own * out.rgb[c] + (1 - own) * stand_in;
    }
    return out;
}

}  // namespace

std::optional<Fragment> resolve_surface(std::span<const LayerTerm> terms, const FocusGeometry& geometry) {
    std::size_t own = 0;  // terms of the surface itself
    while (own < terms.size() && terms[own].part->path == 0) ++own;
    if (own == 0) return std::nullopt;
    const LayerTerm* seen = terms[0].part->kind == Kind::seen ? terms.data() : nullptr;
    const LayerTerm* hidden = terms[own - 1].part->kind == Kind::hidden ? &terms[own - 1] : nullptr;
    auto out = fragment_of(seen, hidden);
    if (!out || own == terms.size()) return out;
    thread_local std::vector<Chain> chains;
    chains.clear();
    // The longest first: paths grow from a chain to those that go on from it.
    for (std::size_t end = terms.size(); end > own;) {
        std::size_t begin = end - 1;
        while (begin > own && terms[begin - 1].part->path == terms[end - 1].part->path) --begin;
        chains.push_back(resolve_chain(terms.subspan(begin, end - begin), chains, geometry));
        end = begin;
    }
    for (const Chain& chain : chains) {
        if (NodePath(chain.path).depth() != 1) continue;
        show(out->seen, chain.mask, chain.rgb);
        show(out->hidden, chain.hidden_mask, chain.rgb);
    }
    return out;
}

}  // namespace postlens
