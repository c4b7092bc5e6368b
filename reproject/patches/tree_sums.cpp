#include "reproject/patches/tree_sums.h"

#include <algorithm>
#include <cmath>

#include "reproject/sheets/sample_surfaces.h"

namespace postlens {
namespace {

/// Smallest fraction of views (images for one lens point and instant), by weight, that must show a reflected
/// surface so that their mean is reliable. Only views that need the surface are counted. If fewer views show
/// it, the mean is mixed with the pinhole's radiance.
constexpr double enough_known = 0.25;

}  // namespace

void TreeSums::begin(std::vector<NodePath> paths, const TilePlace& at) {
    at_ = at;
    std::sort(paths.begin(), paths.end(), [](NodePath a, NodePath b) { return a.bits() < b.bits(); });
    paths.erase(std::unique(paths.begin(), paths.end()), paths.end());
    for (Chain& c : chains_) spare_.push_back(std::move(c));
    chains_.clear();
    first_ = {no_chain, no_chain};
    for (const NodePath path : paths) {
        const auto number = static_cast<std::uint32_t>(chains_.size());
        std::size_t parent = number;
        if (path.depth() > 1) {
            const std::uint32_t found = number_of(path.parent());
            if (found == no_chain) continue;  // no view has its parent path
            parent = found;
        }
        Chain c;
        if (!spare_.empty()) {
            c = std::move(spare_.back());
            spare_.pop_back();
        }
        if (!c.seen) c.seen = std::make_unique<SeenTile>();
        c.path = path;
        c.parent = parent;
        c.bounce = child_bit(path.kind());
        c.part = {};
        c.children = {no_chain, no_chain};
        c.brightest = 0;
        c.used = c.any_wanted = c.any_seen = false;
        chains_.push_back(std::move(c));
        (parent == number ? first_ : chains_[parent].children)[static_cast<std::size_t>(path.kind()) - 1] =
            number;
    }
}

void TreeSums::begin_use(const PatchMesh& primary_mesh, const PatchMesh* deeper_mesh,
                         const SeenTile& primary) {
    primary_mesh_ = &primary_mesh;
    deeper_mesh_ = deeper_mesh;
    primary_ = &primary;
    for (Chain& c : chains_) c.part = {};
    if (deeper_mesh != nullptr) primary_part_ = find_parents(primary_mesh, primary, at_);
}

TreeSums::Sums& TreeSums::sums_of(Chain& chain, std::size_t k) {
    if (!chain.used) {
        chain.used = true;
        chain.sums.resize(SeenTile::pixels);
        fill_pixels(at_, chain.sums, {});
    }
    return chain.sums[k];
}

std::uint32_t TreeSums::number_of(NodePath path) const {
    const auto found = std::lower_bound(chains_.begin(), chains_.end(), path,
                                        [](const Chain& c, NodePath p) { return c.path.bits() < p.bits(); });
    return found != chains_.end() && found->path == path ? static_cast<std::uint32_t>(found - chains_.begin())
                                                         : no_chain;
}

SeenTile* TreeSums::begin_chain(NodePath path, WantedPixels& wanted) {
    const std::uint32_t number = number_of(path);
    if (number == no_chain) return nullptr;
    Chain& c = chains_[number];
    const bool first = c.parent == number;
    if (!first && chains_[c.parent].part.empty()) return nullptr;
    if (first) {
        find_wanted(*primary_mesh_, *primary_, c.bounce, primary_part_, {}, wanted, *c.seen);
    } else {
        const Chain& parent = chains_[c.parent];
        find_wanted(
            *deeper_mesh_, *parent.seen, c.bounce, parent.part,
            [&](std::size_t k) { return id_around(parent, k); }, wanted, *c.seen);
    }
    c.part = wanted.part;
    return c.part.empty() ? nullptr : c.seen.get();
}

std::uint32_t TreeSums::id_around(const Chain& chain, std::size_t k) const {
    if (chains_[chain.parent].path == chain.path) return primary_mesh_->id_of(primary_->texel[k]);
    const Chain& parent = chains_[chain.parent];
    const std::uint32_t texel = parent.seen->texel[k];
    if (texel == SeenTile::no_texel) return id_around(parent, k);
    return deeper_mesh_->id_of(texel & ~SeenTile::bent);
}

bool TreeSums::sure(std::size_t k) const {
    const std::uint32_t in = primary_->texel[k];
    return in != SeenTile::no_texel && sure(k, first_, primary_mesh_->drawn_children(in));
}

bool TreeSums::sure(std::size_t k, const Children& chains, std::uint8_t children) const {
    for (std::size_t bounce = 0; bounce < chains.size(); ++bounce) {
        if ((children >> bounce & 1U) == 0) continue;
        if (chains[bounce] == no_chain) return false;
        const Chain& c = chains_[chains[bounce]];
        const std::uint32_t texel = c.part.empty() ? SeenTile::no_texel : c.seen->texel[k];
        if (texel == SeenTile::no_texel || (texel & SeenTile::bent) != 0 || c.seen->may_be_hidden(k) ||
            deeper_mesh_->unsure(texel) || !sure(k, c.children, deeper_mesh_->drawn_children(texel)))
            return false;
    }
    return true;
}

glm::dvec3 TreeSums::light(std::size_t k) const {
    return light(k, first_, primary_mesh_->drawn_children(primary_->texel[k]));
}

glm::dvec3 TreeSums::light(std::size_t k, const Children& chains, std::uint8_t children) const {
    glm::dvec3 out(0);
    for (std::size_t bounce = 0; bounce < chains.size(); ++bounce) {
        if ((children >> bounce & 1U) == 0) continue;
        const Chain& c = chains_[chains[bounce]];
        const std::uint32_t texel = c.seen->texel[k];
        out += glm::dvec3(deeper_mesh_->light(texel)) +
               light(k, c.children, deeper_mesh_->drawn_children(texel));
    }
    return out;
}

void TreeSums::add(std::size_t k, double weight) {
    const std::uint32_t in = primary_->texel[k];
    if (in == SeenTile::no_texel) return;
    add(k, weight, first_, primary_mesh_->drawn_children(in), in);
}

void TreeSums::add(std::size_t k, double weight, const Children& chains, std::uint8_t children,
                   std::uint32_t primary_texel) {
    for (std::size_t bounce = 0; bounce < chains.size(); ++bounce) {
        if (chains[bounce] == no_chain) continue;
        Chain& c = chains_[chains[bounce]];
        if ((children & c.bounce) == 0) continue;
        Sums& s = sums_of(c, k);
        s.wanted += weight;
        c.any_wanted = true;
        const std::uint32_t texel = c.part.empty() ? SeenTile::no_texel : c.seen->texel[k];
        if (texel != SeenTile::no_texel) {
            add_seen(k, weight, c, texel, primary_texel);
        } else if (!c.part.empty() && add_beside(k, weight, c, primary_texel)) {
            s.beside += weight;
        } else if (c.path.depth() == 1) {
            const auto& rgb = primary_mesh_->sheets->below[primary_texel][bounce];
            c.brightest = std::max({c.brightest, rgb[0], rgb[1], rgb[2]});
            c.any_seen = true;
            for (std::size_t n = 0; n < 3; ++n) s.instead[n] += weight * static_cast<double>(rgb[n]);
        }
    }
}

void TreeSums::add_seen(std::size_t k, double weight, Chain& chain, std::uint32_t texel,
                        std::uint32_t primary_texel) {
    const std::uint32_t number = texel & ~SeenTile::bent;
    const glm::vec3 light = deeper_mesh_->light(number);
    Sums& s = sums_of(chain, k);
    if ((texel & SeenTile::bent) != 0) s.bent += weight;
    chain.brightest = std::max({chain.brightest, light[0], light[1], light[2]});
    chain.any_seen = true;
    s.known += weight;
    for (std::size_t c = 0; c < 3; ++c) s.seen[c] += weight * static_cast<double>(light[static_cast<int>(c)]);
    const std::uint8_t children = deeper_mesh_->drawn_children(number);
    if (children != 0) add(k, weight, chain.children, children, primary_texel);
}

bool TreeSums::add_beside(std::size_t k, double weight, const Chain& chain, std::uint32_t primary_texel) {
    bool any = false;
    for (const std::uint32_t number : chain.children) {
        if (number == no_chain || chains_[number].part.empty()) continue;
        Chain& c = chains_[number];
        Sums& s = sums_of(c, k);
        const std::uint32_t texel = c.seen->texel[k];
        if (texel != SeenTile::no_texel) {
            add_seen(k, weight, c, texel, primary_texel);
        } else if (add_beside(k, weight, c, primary_texel)) {
            s.beside += weight;
        } else {
            continue;
        }
        s.wanted += weight;
        s.alone += weight;
        any = true;
    }
    return any;
}

void TreeSums::end_views() {
    used_.clear();
    for (std::size_t i = 0; i < chains_.size(); ++i) {
        if (chains_[i].used) used_.push_back(i);
    }
    for (std::size_t i = chains_.size(); i-- > 0;) {
        Chain& c = chains_[i];
        if (c.any_wanted && !c.any_seen) c.brightest = HUGE_VALF;
        if (c.parent != i) chains_[c.parent].brightest += c.brightest;
    }
}

double TreeSums::sum_up(std::size_t k, double weight, std::array<double, 3>& sum) {
    for (const std::size_t i : used_) {
        const Chain& c = chains_[i];
        Sums& s = chains_[i].sums[k];
        if (s.wanted <= 0) continue;
        const double resolved = s.known + s.beside, missing = s.wanted - resolved;
        const bool first = c.parent == i;
        double inflated = 1;
        if (!first) {
            const Sums& in = chains_[c.parent].sums[k];
            inflated = in.known + s.alone > 0 ? in.total / (in.known + s.alone) : 0;
        }
        const double by_mean = first ? std::min(1.0, resolved / (enough_known * s.wanted)) : 1.0;
        s.total = inflated * (resolved + by_mean * missing);
        const double scale = s.known > 0 ? s.total / s.known : 0;
        for (std::size_t n = 0; n < 3; ++n) sum[n] += scale * s.seen[n] + (1 - by_mean) * s.instead[n];
    }
    const double light = std::max({sum[0], sum[1], sum[2]}) / weight;
    double unknown = 0;
    for (const std::size_t i : used_) {
        const Chain& c = chains_[i];
        const Sums& s = c.sums[k];
        const auto brightest = static_cast<double>(c.brightest);
        const bool misses_parent = c.parent != i && chains_[c.parent].sums[k].beside > 0;
        const double missing = s.wanted - s.known - s.beside + (misses_parent ? s.bent : 0);
        if (missing <= 0 || brightest <= 0) continue;
        unknown = std::max(unknown, missing * (brightest < light ? brightest / light : 1));
    }
    return unknown;
}

}  // namespace postlens
