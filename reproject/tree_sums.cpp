#include "reproject/tree_sums.h"

#include <algorithm>

#include "reproject/sample_surfaces.h"

namespace postlens {
namespace {

/// Of what is asked for, the share that must be known for its mean to stand for the rest alone.
constexpr double enough_known = 0.25;

}  // namespace

void TreeSums::begin(std::vector<NodePath> paths) {
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
            if (found == no_chain) continue;  // nothing to see it in
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
        c.sums.assign(SeenTile::pixels, {});
        chains_.push_back(std::move(c));
        (parent == number ? first_ : chains_[parent].children)[static_cast<std::size_t>(path.kind()) - 1] =
            number;
    }
}

void TreeSums::begin_use(const SheetMesh& primary_mesh, const SheetMesh* deeper_mesh,
                         const SeenTile& primary) {
    primary_mesh_ = &primary_mesh;
    deeper_mesh_ = deeper_mesh;
    primary_ = &primary;
    for (Chain& c : chains_) c.part = {};
    if (deeper_mesh != nullptr) primary_part_ = find_parents(primary_mesh, primary);
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
        find_wanted(*primary_mesh_, *primary_, c.bounce, primary_part_, wanted, *c.seen);
    } else {
        find_wanted(*deeper_mesh_, *chains_[c.parent].seen, c.bounce, chains_[c.parent].part, wanted,
                    *c.seen);
    }
    c.part = wanted.part;
    return c.part.empty() ? nullptr : c.seen.get();
}

void TreeSums::add(std::size_t k, double weight) {
    const std::uint32_t in = primary_->texel[k];
    if (in != SeenTile::no_texel) add(k, weight, first_, primary_mesh_->texels[in], in);
}

void TreeSums::add(std::size_t k, double weight, const Children& chains, const Texel& in_texel,
                   std::uint32_t primary_texel) {
    for (std::size_t bounce = 0; bounce < chains.size(); ++bounce) {
        if (chains[bounce] == no_chain) continue;
        Chain& c = chains_[chains[bounce]];
        if ((in_texel.children() & c.bounce) == 0) continue;
        Sums& s = c.sums[k];
        s.wanted += weight;
        const std::uint32_t texel = c.part.empty() ? SeenTile::no_texel : c.seen->texel[k];
        if (texel != SeenTile::no_texel) {
            const Texel& t = deeper_mesh_->texels[texel];
            s.known += weight;
            s.seen[0] += weight * static_cast<double>(t.r);
            s.seen[1] += weight * static_cast<double>(t.g);
            s.seen[2] += weight * static_cast<double>(t.b);
            if (t.children() != 0) add(k, weight, c.children, t, primary_texel);
        } else if (c.path.depth() == 1) {
            const auto& rgb = primary_mesh_->below[primary_texel][bounce];
            for (std::size_t n = 0; n < 3; ++n) s.instead[n] += weight * static_cast<double>(rgb[n]);
        }
    }
}

double TreeSums::sum_up(std::size_t k, std::array<double, 3>& sum) {
    double unknown = 0;
    for (std::size_t i = 0; i < chains_.size(); ++i) {
        const Chain& c = chains_[i];
        Sums& s = chains_[i].sums[k];
        if (s.wanted <= 0) continue;
        unknown = std::max(unknown, s.wanted - s.known);
        // Where the parent's mean stands for what was not seen of it, this counts as much more.
        const bool first = c.parent == i;
        const double parent = first ? 1 : chains_[c.parent].sums[k].scale;
        const double by_mean = first ? std::min(1.0, s.known / (enough_known * s.wanted)) : 1.0;
        s.scale = s.known > 0 ? parent * (1 + by_mean * (s.wanted - s.known) / s.known) : 0.0;
        for (std::size_t n = 0; n < 3; ++n) sum[n] += s.scale * s.seen[n] + (1 - by_mean) * s.instead[n];
    }
    return unknown;
}

}  // namespace postlens
