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
    for (const NodePath path : paths) {
        std::size_t parent = chains_.size();
        if (path.depth() > 1) {
            const auto found = std::find_if(chains_.begin(), chains_.end(),
                                            [&](const Chain& c) { return c.path == path.parent(); });
            if (found == chains_.end()) continue;  // nothing to see it in
            parent = static_cast<std::size_t>(found - chains_.begin());
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
        c.sums.assign(SeenTile::pixels, {});
        chains_.push_back(std::move(c));
    }
}

void TreeSums::begin_use(const SheetMesh& primary_mesh, const SheetMesh* deeper_mesh,
                         const SeenTile& primary) {
    primary_mesh_ = &primary_mesh;
    deeper_mesh_ = deeper_mesh;
    primary_ = &primary;
    for (Chain& c : chains_) c.seen->clear();
}

SeenTile* TreeSums::seen(NodePath path) {
    const auto found =
        std::find_if(chains_.begin(), chains_.end(), [&](const Chain& c) { return c.path == path; });
    return found != chains_.end() ? found->seen.get() : nullptr;
}

void TreeSums::add(std::size_t k, double weight) {
    for (std::size_t i = 0; i < chains_.size(); ++i) {
        Chain& c = chains_[i];
        const bool first = c.parent == i;
        const std::uint32_t in = first ? primary_->texel[k] : chains_[c.parent].seen->texel[k];
        if (in == SeenTile::no_texel) continue;
        if (((first ? primary_mesh_ : deeper_mesh_)->texels[in].children() & c.bounce) == 0) continue;
        Sums& s = c.sums[k];
        s.wanted += weight;
        const std::uint32_t texel = c.seen->texel[k];
        if (texel != SeenTile::no_texel) {
            const Texel& t = deeper_mesh_->texels[texel];
            s.known += weight;
            s.seen[0] += weight * static_cast<double>(t.r);
            s.seen[1] += weight * static_cast<double>(t.g);
            s.seen[2] += weight * static_cast<double>(t.b);
        } else if (first) {
            const auto& rgb = primary_mesh_->below[in][static_cast<std::size_t>(c.path.kind()) - 1];
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
