#include "reproject/sheet_builder.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace postlens {
namespace {

constexpr int edge = SheetMesh::square_px;
constexpr std::size_t cells_of_square = static_cast<std::size_t>(edge) * edge;
constexpr std::uint32_t none = 0xFFFFFFFFU;

}  // namespace

SheetBuilder::SheetBuilder(const PixelLeaves& leaves, const SampleTrees& trees, const SampleHeader& header,
                           const HighlightRule& rule, SheetMesh& out)
    : leaves_(leaves),
      trees_(trees),
      rule_(rule),
      out_(out),
      per_px_(across_per_px(header)),
      perspective_(header.projection == Projection::perspective) {}

bool SheetBuilder::continuous(float low, float high, float size) const {
    return is_one_surface(low, high, static_cast<double>(size) * per_px_, perspective_);
}

void SheetBuilder::build(const SheetSquare& square) {
    square_ = square;
    pieces_.clear();
    for (int row = 0; row < square.rows; ++row) {
        for (int column = square.first_pixel; column < square.last_pixel; ++column) {
            const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(square.band_width) +
                               static_cast<std::size_t>(column);
            const int cell = row * edge + column - square.first_pixel;
            for (std::uint32_t i = leaves_.leaf_offsets[pixel]; i < leaves_.leaf_offsets[pixel + 1]; ++i)
                add_leaf(leaves_.leaves[i], cell, square);
        }
    }
    const auto by_key = [](const Piece& a, const Piece& b) { return a.key < b.key; };
    if (!std::is_sorted(pieces_.begin(), pieces_.end(), by_key))
        std::stable_sort(pieces_.begin(), pieces_.end(), by_key);
    for (std::size_t i = 0; i < pieces_.size();) {
        std::size_t end = i;
        while (end < pieces_.size() && pieces_[end].key == pieces_[i].key) ++end;
        add_sheets(i, end, square);
        i = end;
    }
}

void SheetBuilder::add_leaf(const Leaf& leaf, int cell, const SheetSquare& square) {
    const PointSample& at = leaves_.points.samples[leaf.corner[0]];
    const float x = at.x - static_cast<float>(square.x + cell % edge),
                y = at.y - static_cast<float>(square.y + cell / edge);
    struct Entry {
        SheetKey key;
        std::uint32_t occurrence = 0, corner = 0, node = 0;
    };
    thread_local std::vector<Entry> entries;
    entries.clear();
    bool simple = true;
    for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t begin = trees_.offsets[leaf.corner[k]], end = trees_.offsets[leaf.corner[k] + 1];
        simple = simple && end == begin + 1;
        for (std::uint32_t i = begin; i < end; ++i) {
            const TreeSurface& s = node(i);
            Entry e{{s.path, s.parent_id, s.id}, 0, k, i};
            for (auto p = entries.crbegin(); p != entries.crend() && p->corner == k; ++p)
                e.occurrence += p->key == e.key ? 1U : 0U;
            entries.push_back(e);
        }
    }
    if (entries.empty()) return;
    if (simple && entries[1].key == entries[0].key && entries[2].key == entries[0].key &&
        entries[3].key == entries[0].key) {  // by far the most
        add_group(entries[0].key, {entries[0].node, entries[1].node, entries[2].node, entries[3].node}, x, y,
                  leaf.size, cell);
        return;
    }
    // What the corners have in common makes squares: the n-th of a key with the n-th.
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return a.key == b.key ? a.occurrence < b.occurrence : a.key < b.key;
    });
    for (std::size_t i = 0; i < entries.size();) {
        std::array<std::uint32_t, 4> corners{none, none, none, none};
        const Entry& first = entries[i];
        for (; i < entries.size() && entries[i].key == first.key && entries[i].occurrence == first.occurrence;
             ++i)
            corners[entries[i].corner] = entries[i].node;
        add_group(first.key, corners, x, y, leaf.size, cell);
    }
}

void SheetBuilder::add_group(const SheetKey& key, const std::array<std::uint32_t, 4>& corners, float x,
                             float y, float size, int cell) {
    if (std::find(corners.begin(), corners.end(), none) == corners.end()) {
        const auto [low, high] = std::minmax({node(corners[0]).inverse_z, node(corners[1]).inverse_z,
                                              node(corners[2]).inverse_z, node(corners[3]).inverse_z});
        if (continuous(low, high, size)) {
            pieces_.push_back({key, cell, x, y, size, corners, 4, 0, 0});
            return;
        }
    }
    const float half = size / 2;
    for (std::size_t k = 0; k < 4; ++k) {
        if (corners[k] == none) continue;
        const bool right = (k & 1U) != 0, down = (k & 2U) != 0;
        pieces_.push_back({key,
                           cell,
                           right ? x + half : x,
                           down ? y + half : y,
                           half,
                           {corners[k]},
                           1,
                           right ? x + size : x,
                           down ? y + size : y});
    }
}

void SheetBuilder::add_sheets(std::size_t begin, std::size_t end, const SheetSquare& square) {
    // Parts of a cell that cannot be one surface: each with its range of depths.
    struct Part {
        float low = 0, high = 0;
        std::vector<const Piece*> pieces;
    };
    thread_local std::vector<Part> parts;
    drafts_used_ = 0;
    for (std::size_t i = begin; i < end;) {
        const int cell = pieces_[i].cell;
        std::size_t used = 0;
        for (; i < end && pieces_[i].cell == cell; ++i) {
            const Piece& p = pieces_[i];
            float low = node(p.node[0]).inverse_z, high = low;
            for (int k = 1; k < p.corners; ++k) {
                low = std::min(low, node(p.node[static_cast<std::size_t>(k)]).inverse_z);
                high = std::max(high, node(p.node[static_cast<std::size_t>(k)]).inverse_z);
            }
            std::size_t part = 0;
            while (part < used &&
                   !continuous(std::min(low, parts[part].low), std::max(high, parts[part].high), 1))
                ++part;
            if (part == used) {
                if (used == parts.size()) parts.emplace_back();
                parts[used].pieces.clear();
                parts[used].low = low;
                parts[used++].high = high;
            }
            parts[part].low = std::min(parts[part].low, low);
            parts[part].high = std::max(parts[part].high, high);
            parts[part].pieces.push_back(&p);
        }
        for (std::size_t s = 0; s < used; ++s) {
            if (s == drafts_used_) {
                if (drafts_used_ == drafts_.size()) drafts_.emplace_back();
                Draft& d = drafts_[drafts_used_++];
                d.key = pieces_[begin].key;
                d.fine.assign(cells_of_square, SheetNode::none);
                d.coarse.assign(cells_of_square, SheetNode::none);
                d.planes.assign(cells_of_square * out_.values, {});
                d.depth = 0;
                d.number = static_cast<std::uint32_t>(out_.sheets.size() + s);
            }
            add_cell(s, parts[s].pieces, cell);
        }
    }
    emit(square);
}

void SheetBuilder::note_bright(std::size_t first_light, float area) {
    if (out_.bright.size() == first_light) return;
    const Texel& t = out_.texels.back();
    out_.bright_texels.push_back({static_cast<std::uint32_t>(out_.texels.size() - 1),
                                  static_cast<std::uint32_t>(first_light),
                                  static_cast<std::uint32_t>(out_.bright.size() - first_light),
                                  area,
                                  {t.r, t.g, t.b}});
}

std::uint32_t SheetBuilder::add_texel(std::size_t sheet, const Piece& piece) {
    std::array<float, 3> rgb{};
    const std::size_t first_light = out_.bright.size();
    std::uint8_t children = 0;
    std::array<std::array<float, 3>, 2> below{};
    Texel t;
    const float share = 1.0F / static_cast<float>(piece.corners);
    for (int k = 0; k < piece.corners; ++k) {
        const TreeSurface& s = node(piece.node[static_cast<std::size_t>(k)]);
        std::array<float, 3> colour = s.rgb, excess{};
        for (std::size_t c = 0; c < 3; ++c) {
            excess[c] = std::max(0.0F, colour[c] - rule_.above);
            colour[c] -= excess[c];
        }
        for (std::size_t c = 0; c < 3; ++c) {
            rgb[c] += share * colour[c];
            for (std::size_t n = 0; n < 2; ++n) below[n][c] += share * s.below[n][c];
        }
        children |= s.children;
        if (excess == std::array<float, 3>{}) continue;
        // The quarter of the square next to this corner.
        const bool whole = piece.corners == 4;
        const float area = share * piece.size * piece.size;
        const float x = piece.x + piece.size * (whole ? ((k & 1) != 0 ? 0.75F : 0.25F) : 0.5F),
                    y = piece.y + piece.size * (whole ? ((k & 2) != 0 ? 0.75F : 0.25F) : 0.5F);
        Highlight light;
        light.x = x + static_cast<float>(square_.x + piece.cell % edge);
        light.y = y + static_cast<float>(square_.y + piece.cell / edge);
        light.rgb = {area * excess[0], area * excess[1], area * excess[2]};
        light.w = s.path.bits() == 0 ? Mat2::isotropic(s.inverse_z) : s.w;
        light.inverse_z = s.inverse_z;
        light.sheet = drafts_[sheet].number;
        out_.bright.push_back(light);
    }
    t.r = rgb[0];
    t.g = rgb[1];
    t.b = rgb[2];
    t.info = (drafts_[sheet].number << 2U) | children;
    out_.texels.push_back(t);
    note_bright(first_light, piece.size * piece.size);
    if (children != 0 && drafts_[sheet].key.path.bits() == 0) {
        out_.below.resize(out_.texels.size());
        out_.below.back() = below;
    } else if (!out_.below.empty()) {
        out_.below.resize(out_.texels.size());
    }
    const double area = static_cast<double>(piece.size) * static_cast<double>(piece.size);
    for (std::size_t c = 0; c < 3; ++c) {
        mean_.rgb[c] += area * static_cast<double>(rgb[c]);
        for (std::size_t n = 0; n < 2; ++n) mean_.below[n][c] += area * static_cast<double>(below[n][c]);
    }
    mean_.children |= children;
    mean_.area += area;
    ++mean_.texels;
    return SheetNode::leaf | static_cast<std::uint32_t>(out_.texels.size() - 1);
}

void SheetBuilder::add_cell(std::size_t sheet, std::span<const Piece* const> pieces, int cell) {
    Draft& draft = drafts_[sheet];
    const auto at = static_cast<std::size_t>(cell);
    tree_pieces_.assign(pieces.begin(), pieces.end());
    mean_ = {};
    const std::size_t first_light = out_.bright.size();
    draft.fine[at] = add_tree(sheet, tree_pieces_, 0, tree_pieces_.size(), 0, 0, 1, 0);
    draft.coarse[at] = draft.fine[at];
    if (mean_.texels > 1 && mean_.area > 1 - 1e-9) {
        out_.texels.push_back({static_cast<float>(mean_.rgb[0]), static_cast<float>(mean_.rgb[1]),
                               static_cast<float>(mean_.rgb[2]), (draft.number << 2U) | mean_.children});
        note_bright(first_light, 1);
        if (!out_.below.empty()) {
            out_.below.resize(out_.texels.size());
            for (std::size_t n = 0; n < 2; ++n) {
                for (std::size_t c = 0; c < 3; ++c)
                    out_.below.back()[n][c] = static_cast<float>(mean_.below[n][c]);
            }
        }
        draft.coarse[at] = SheetNode::leaf | static_cast<std::uint32_t>(out_.texels.size() - 1);
    }
    fit(pieces, draft.planes.data() + at * out_.values);
}

std::uint32_t SheetBuilder::add_tree(std::size_t sheet, std::vector<const Piece*>& pieces, std::size_t begin,
                                     std::size_t end, float x, float y, float size, int depth) {
    if (begin == end) return SheetNode::none;
    if (pieces[begin]->size >= size) return add_texel(sheet, *pieces[begin]);
    drafts_[sheet].depth = std::max(drafts_[sheet].depth, depth + 1);
    const float half = size / 2;
    const auto first = static_cast<std::uint32_t>(out_.nodes.size());
    out_.nodes.resize(out_.nodes.size() + 4, SheetNode::none);
    const auto at = [&](std::size_t i) { return pieces.begin() + static_cast<std::ptrdiff_t>(i); };
    std::size_t from = begin;
    for (std::uint32_t k = 0; k < 4; ++k) {
        const float cx = (k & 1U) != 0 ? x + half : x, cy = (k & 2U) != 0 ? y + half : y;
        const auto middle = std::stable_partition(at(from), at(end), [&](const Piece* p) {
            return p->x >= cx && p->x < cx + half && p->y >= cy && p->y < cy + half;
        });
        const auto to = static_cast<std::size_t>(middle - pieces.begin());
        const std::uint32_t child = add_tree(sheet, pieces, from, to, cx, cy, half, depth + 1);
        out_.nodes[first + k] = child;
        from = to;
    }
    return first;
}

void SheetBuilder::fit(std::span<const Piece* const> pieces, Plane* planes) const {
    // Least squares around the middle of the cell; slopes that little is known of stay small.
    double weight = 0, mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
    std::array<double, 5> mean{}, vx{}, vy{};
    const std::size_t values = out_.values;
    const auto each = [&](const auto& visit) {
        for (const Piece* p : pieces) {
            const double area = static_cast<double>(p->size) * static_cast<double>(p->size) / p->corners;
            for (int k = 0; k < p->corners; ++k) {
                const double x = static_cast<double>(p->corners == 1 ? p->at_x
                                                     : (k & 1) != 0  ? p->x + p->size
                                                                     : p->x),
                             y = static_cast<double>(p->corners == 1 ? p->at_y
                                                     : (k & 2) != 0  ? p->y + p->size
                                                                     : p->y);
                const TreeSurface& s = node(p->node[static_cast<std::size_t>(k)]);
                visit(area, x, y,
                      std::array<double, 5>{static_cast<double>(s.inverse_z), static_cast<double>(s.w.xx),
                                            static_cast<double>(s.w.xy), static_cast<double>(s.w.yx),
                                            static_cast<double>(s.w.yy)});
            }
        }
    };
    each([&](double a, double x, double y, const std::array<double, 5>& v) {
        weight += a;
        mx += a * x;
        my += a * y;
        for (std::size_t i = 0; i < values; ++i) mean[i] += a * v[i];
    });
    mx /= weight;
    my /= weight;
    for (double& m : mean) m /= weight;
    each([&](double a, double x, double y, const std::array<double, 5>& v) {
        xx += a * (x - mx) * (x - mx);
        xy += a * (x - mx) * (y - my);
        yy += a * (y - my) * (y - my);
        for (std::size_t i = 0; i < values; ++i) {
            vx[i] += a * (x - mx) * (v[i] - mean[i]);
            vy[i] += a * (y - my) * (v[i] - mean[i]);
        }
    });
    constexpr double ridge = 1e-3;  // px^2
    xx += ridge * weight;
    yy += ridge * weight;
    const double det = xx * yy - xy * xy;
    for (std::size_t i = 0; i < values; ++i) {
        const double dx = (yy * vx[i] - xy * vy[i]) / det, dy = (xx * vy[i] - xy * vx[i]) / det;
        planes[i] = {static_cast<float>(mean[i] + dx * (0.5 - mx) + dy * (0.5 - my)), static_cast<float>(dx),
                     static_cast<float>(dy)};
    }
}

void SheetBuilder::emit(const SheetSquare& square) {
    for (std::size_t s = 0; s < drafts_used_; ++s) {
        const Draft& d = drafts_[s];
        int x0 = edge, x1 = 0, y0 = edge, y1 = 0;
        Sheet sheet;
        sheet.inverse_z_min = HUGE_VALF;
        sheet.inverse_z_max = -HUGE_VALF;
        for (int cell = 0; cell < edge * edge; ++cell) {
            const auto at = static_cast<std::size_t>(cell);
            if (d.fine[at] == SheetNode::none) continue;
            x0 = std::min(x0, cell % edge);
            x1 = std::max(x1, cell % edge + 1);
            y0 = std::min(y0, cell / edge);
            y1 = std::max(y1, cell / edge + 1);
            const float z = d.planes[at * out_.values].value;
            sheet.inverse_z_min = std::min(sheet.inverse_z_min, z);
            sheet.inverse_z_max = std::max(sheet.inverse_z_max, z);
        }
        sheet.key = d.key;
        sheet.x = square.x + x0;
        sheet.y = square.y + y0;
        sheet.width = x1 - x0;
        sheet.height = y1 - y0;
        sheet.depth = d.depth;
        sheet.first_cell = static_cast<std::uint32_t>(out_.fine.size());
        for (int y = y0; y < y1; ++y) {
            const auto from = static_cast<std::size_t>(y * edge + x0),
                       to = static_cast<std::size_t>(y * edge + x1);
            out_.fine.insert(out_.fine.end(), d.fine.begin() + static_cast<std::ptrdiff_t>(from),
                             d.fine.begin() + static_cast<std::ptrdiff_t>(to));
            out_.coarse.insert(out_.coarse.end(), d.coarse.begin() + static_cast<std::ptrdiff_t>(from),
                               d.coarse.begin() + static_cast<std::ptrdiff_t>(to));
            out_.planes.insert(out_.planes.end(),
                               d.planes.begin() + static_cast<std::ptrdiff_t>(from * out_.values),
                               d.planes.begin() + static_cast<std::ptrdiff_t>(to * out_.values));
        }
        out_.sheets.push_back(sheet);
    }
}

}  // namespace postlens
