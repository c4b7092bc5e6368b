#include "reproject/sheets/leaf_pieces.h"

#include <algorithm>
#include <utility>

#include "reproject/sheets/sheet_mesh.h"

namespace postlens {
namespace {

constexpr std::uint32_t none = 0xFFFFFFFFU;

}  // namespace

LeafPieces::LeafPieces(const PixelLeaves& leaves, const SampleTrees& trees, const SheetKeys& keys,
                       const SampleHeader& header)
    : leaves_(leaves),
      trees_(trees),
      keys_(keys),
      per_px_(across_per_px(header)),
      perspective_(header.projection == Projection::perspective),
      key_pieces_(keys.keys.size(), 0),
      key_group_(keys.keys.size(), none) {}

void LeafPieces::collect(const SheetSquare& square) {
    square_ = square;
    pieces_.clear();
    keys_used_.clear();
    for (int row = 0; row < square.rows; ++row) {
        for (int column = square.first_pixel; column < square.last_pixel; ++column) {
            const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(square.band_width) +
                               static_cast<std::size_t>(column);
            const int cell = row * SheetMesh::square_px + column - square.first_pixel;
            for (std::uint32_t i = leaves_.leaf_offsets[pixel]; i < leaves_.leaf_offsets[pixel + 1]; ++i)
                add_leaf(i, cell);
        }
    }
    sort_pieces();
}

void LeafPieces::sort_pieces() {
    std::sort(keys_used_.begin(), keys_used_.end());
    std::uint32_t begin = 0;
    for (const std::uint32_t key : keys_used_) begin += std::exchange(key_pieces_[key], begin);
    sorted_.resize(pieces_.size());
    for (const LeafPiece& p : pieces_) sorted_[key_pieces_[p.key]++] = &p;
}

void LeafPieces::add_leaf(std::uint32_t index, int cell) {
    const Leaf& leaf = leaves_.leaves[index];
    const PointSample& at = leaves_.points.samples[leaf.corner[0]];
    const int row = cell / SheetMesh::square_px;
    const float x = at.x - static_cast<float>(square_.x + cell % SheetMesh::square_px),
                y = at.y - static_cast<float>(square_.y + row);
    std::array<std::uint32_t, 4> begin{};
    bool simple = true;
    for (std::size_t k = 0; k < 4; ++k) {
        begin[k] = trees_.offsets[leaf.corner[k]];
        simple = simple && trees_.offsets[leaf.corner[k] + 1] == begin[k] + 1 &&
                 keys_.of_node[begin[k]] == keys_.of_node[begin[0]];
    }
    if (simple) {  // by far the most frequent case
        add_group(keys_.of_node[begin[0]], begin, x, y, cell, index);
        return;
    }
    // The rays through the four corners of this quadtree cell may hit the same surface several times, for
    // example its front and its back. For each surface, the nearest hits of the four rays form one group, the
    // second nearest hits form another group, and so on.
    groups_.clear();
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::uint32_t i = begin[k]; i < trees_.offsets[leaf.corner[k] + 1]; ++i) {
            const std::uint32_t key = keys_.of_node[i];
            std::uint32_t before = none, at_group = key_group_[key];
            while (at_group != none && groups_[at_group].corners[k] != none) {
                before = at_group;
                at_group = groups_[at_group].next;
            }
            if (at_group == none) {
                at_group = static_cast<std::uint32_t>(groups_.size());
                (before == none ? key_group_[key] : groups_[before].next) = at_group;
                groups_.push_back({key, none, {none, none, none, none}});
            }
            groups_[at_group].corners[k] = i;
        }
    }
    for (const Group& g : groups_) {
        add_group(g.key, g.corners, x, y, cell, index);
        key_group_[g.key] = none;
    }
}

void LeafPieces::add_piece(const LeafPiece& piece) {
    if (key_pieces_[piece.key]++ == 0) keys_used_.push_back(piece.key);
    pieces_.push_back(piece);
}

void LeafPieces::add_group(std::uint32_t key, const std::array<std::uint32_t, 4>& corners, float x, float y,
                           int cell, std::uint32_t index) {
    const Leaf& leaf = leaves_.leaves[index];
    const float size = leaf.size;
    if (std::find(corners.begin(), corners.end(), none) == corners.end()) {
        const auto [low, high] = std::minmax({node(corners[0]).inverse_z, node(corners[1]).inverse_z,
                                              node(corners[2]).inverse_z, node(corners[3]).inverse_z});
        if (continuous(low, high, size)) {
            LeafPiece piece{key, index, cell, x, y, size, corners};
            for (std::size_t k = 0; k < 4; ++k) {
                // The first node of a corner is the nearest.
                if (corners[k] != trees_.offsets[leaf.corner[k]] &&
                    beside(leaf.corner[k], node(corners[k]), size).before)
                    piece.hides = Hides::recorded;
            }
            add_piece(piece);
            return;
        }
    }
    std::uint32_t nearest = none;
    for (const std::uint32_t c : corners) {
        if (c != none && (nearest == none || node(c).inverse_z > node(nearest).inverse_z)) nearest = c;
    }
    std::array<Beside, 4> around;
    for (std::size_t k = 0; k < 4; ++k) around[k] = beside(leaf.corner[k], node(nearest), size);
    Hides hides = Hides::nothing;
    for (const Beside& b : around) {
        if (b.before) hides = std::max(hides, b.here || b.behind ? Hides::recorded : Hides::unknown);
    }
    const float half = size / 2;
    const auto quarter = [&](std::size_t k, std::uint32_t of, bool maybe) {
        const bool right = (k & 1U) != 0, down = (k & 2U) != 0;
        add_piece({key,
                   index,
                   cell,
                   right ? x + half : x,
                   down ? y + half : y,
                   half,
                   {of},
                   1,
                   right ? x + size : x,
                   down ? y + size : y,
                   hides,
                   maybe});
    };
    for (std::size_t k = 0; k < 4; ++k) {
        if (corners[k] != none) quarter(k, corners[k], false);
    }
    for (std::size_t k = 0; k < 4; ++k) {
        if (around[k].behind) quarter(k, nearest, true);
    }
}

LeafPieces::Beside LeafPieces::beside(std::uint32_t corner, const TreeSurface& of, float size) const {
    Beside out;
    // A corner's nodes are sorted from near to far.
    for (std::uint32_t i = trees_.offsets[corner]; i < trees_.offsets[corner + 1]; ++i) {
        const TreeSurface& s = node(i);
        if (s.path != of.path || s.parent_id != of.parent_id) continue;
        const auto [low, high] = std::minmax(s.inverse_z, of.inverse_z);
        if (s.id == of.id && continuous(low, high, size)) return {out.before, false, true};
        out.before = out.before || s.inverse_z > of.inverse_z;
        out.behind = out.behind || s.inverse_z < of.inverse_z;
    }
    return out;
}

}  // namespace postlens
