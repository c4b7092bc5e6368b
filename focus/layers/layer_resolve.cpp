#include "focus/layers/layer_resolve.h"

#include <algorithm>
#include <vector>

namespace postlens {
namespace {

using Kind = LayerPart::Kind;

/// Smallest covered fraction of a pixel for a reliable colour of a mirror image. This colour is a mean over
/// the mirror image's blurred samples. If they cover less than this fraction of the pixel, the mean is mixed
/// with a second estimate: the colour of the same image, blurred as if it were painted on the mirror.
constexpr double enough_weight = 0.05;

/// The light that arrives at a pixel after one sequence of bounces, for example after a single reflection.
/// - `terms`: the blurred light of each surface that is seen after these bounces
/// - `rgb`: mean colour of these surfaces, after they have been composited
struct Chain {
    std::span<const LayerTerm> terms;
    std::array<double, 3> rgb{};
    double masks = 0;                  ///< sum of the weights of all masks
    std::array<double, 3> stand_in{};  ///< sum of the colours of all masks, which replaces missing nodes
    double outer = 0;                  ///< sum of the weights of the outer masks
    [[nodiscard]] NodePath path() const { return NodePath(terms[0].part->path); }
};

SurfaceLight light_of(const LayerTerm* term) {
    if (term == nullptr) return {};
    return {std::max(term->weight, 0.0), term->rgb, term->lens};
}

/// Adds the light of a mirror image to `surface`, the mirror that shows it in a pixel. The same is done for
/// what is seen through glass.
/// - `rgb`: mean colour of the image
/// - `mask`: its `alpha` is the fraction of the pixel that shows the image
void show(SurfaceLight& surface, const SurfaceLight& mask, const std::array<double, 3>& rgb) {
    const double share = surface.alpha > 0 ? mask.alpha / surface.alpha : 0;
    for (std::size_t c = 0; c < 3; ++c) surface.rgb[c] += mask.alpha * rgb[c];
    // It is unknown how the image's light varies over the lens. It is assumed to vary like the mirror's
    // alpha, so the lens moment of the light is computed from that of the alpha.
    const double added = share * (rgb[0] + rgb[1] + rgb[2]);
    surface.lens.rgb.x += added * surface.lens.alpha.x;
    surface.lens.rgb.y += added * surface.lens.alpha.y;
}

void show(Fragment& fragment, const SurfaceKey& shown, const Chain& chain) {
    for (const LayerTerm& term : chain.terms) {
        if (term.part->shown != shown) continue;
        if (term.part->kind == Kind::mask) show(fragment.seen, light_of(&term), chain.rgb);
        if (term.part->kind == Kind::hidden_mask) show(fragment.hidden, light_of(&term), chain.rgb);
    }
}

/// Combines the two parts of a surface's blurred light at a pixel: `seen`, from its points that the pinhole
/// sees, and `hidden`, from its points that other surfaces hide from the pinhole. Either pointer may be null.
/// Returns nothing if there is no light.
std::optional<Fragment> fragment_of(const LayerTerm* seen, const LayerTerm* hidden) {
    const double weight = (seen != nullptr ? seen->weight : 0.0) + (hidden != nullptr ? hidden->weight : 0.0);
    if (!(weight > smallest_layer_weight)) return std::nullopt;
    const double depth = (seen != nullptr ? seen->depth : 0.0) + (hidden != nullptr ? hidden->depth : 0.0);
    return Fragment{depth / weight, light_of(seen), light_of(hidden),
                    hidden != nullptr ? std::max(hidden->covered, 0.0) : 0.0};
}

/// Fills `fragments` with the blurred light of each surface in `terms` at a pixel. All these surfaces are
/// seen after the same sequence of reflections and refractions. Returns the fraction of the pixel that they
/// cover.
double gather(std::span<const LayerTerm> terms, std::span<const Chain> longer,
              std::vector<Fragment>& fragments) {
    fragments.clear();
    double weight = 0;
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
        auto fragment = fragment_of(seen, hidden);
        if (!fragment) continue;
        // If the surface is a mirror or glass, adds the light that it shows. This light has one bounce more,
        // and is therefore found in `longer`.
        for (const Chain& next : longer) {
            if (next.path().parent() == NodePath(term.part->path)) show(*fragment, term.part->shown, next);
        }
        fragments.push_back(*fragment);
    }
    return weight;
}

Chain resolve_chain(std::span<const LayerTerm> terms, std::span<const Chain> longer,
                    const FocusGeometry& geometry) {
    thread_local std::vector<Fragment> fragments;
    Chain out{terms};
    for (const LayerTerm& term : terms) {
        if (term.part->kind == Kind::seen || term.part->kind == Kind::hidden) continue;
        const SurfaceLight mask = light_of(&term);
        out.masks += mask.alpha;
        for (std::size_t c = 0; c < 3; ++c) out.stand_in[c] += mask.rgb[c];
        if (term.part->kind == Kind::outer_mask) out.outer += mask.alpha;
    }
    if (!(out.masks > smallest_layer_weight)) return out;
    const double weight = gather(terms, longer, fragments);
    double own = std::clamp(weight / enough_weight, 0.0, 1.0);
    if (weight > smallest_layer_weight) out.rgb = composite(fragments, geometry);
    for (const Chain& next : longer) {
        if (next.path().parent() != out.path() || !(next.outer > smallest_layer_weight)) continue;
        const double share = std::min(next.outer / out.masks, 1.0);
        for (std::size_t c = 0; c < 3; ++c) out.rgb[c] += share * next.rgb[c];
        own = 1;
    }
    for (std::size_t c = 0; own < 1 && c < 3; ++c)
        out.rgb[c] = own * out.rgb[c] + (1 - own) * out.stand_in[c] / out.masks;
    return out;
}

}  // namespace

std::optional<Fragment> resolve_surface(std::span<const LayerTerm> terms, const FocusGeometry& geometry) {
    std::size_t own = 0;  // number of terms of the surface itself
    while (own < terms.size() && terms[own].part->path == 0) ++own;
    if (own == 0) return std::nullopt;
    const LayerTerm* seen = terms[0].part->kind == Kind::seen ? terms.data() : nullptr;
    const LayerTerm* hidden = terms[own - 1].part->kind == Kind::hidden ? &terms[own - 1] : nullptr;
    auto out = fragment_of(seen, hidden);
    if (!out || own == terms.size()) return out;
    thread_local std::vector<Chain> chains;
    chains.clear();
    // Computes the light of each sequence of bounces, the longest first. A mirror that is seen after one
    // bounce shows surfaces that are seen after two, so their light must be known first.
    for (std::size_t end = terms.size(); end > own;) {
        std::size_t begin = end - 1;
        while (begin > own && terms[begin - 1].part->path == terms[end - 1].part->path) --begin;
        chains.push_back(resolve_chain(terms.subspan(begin, end - begin), chains, geometry));
        end = begin;
    }
    for (const Chain& chain : chains) {
        if (chain.path().depth() == 1) show(*out, {}, chain);
    }
    return out;
}

}  // namespace postlens
