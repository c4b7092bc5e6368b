#include "reproject/sheets/sheet_builder.h"

#include <algorithm>
#include <cmath>

namespace postlens {
namespace {

/// If the contrast between the colours at a quadtree cell's corners exceeds this value, the cell is treated
/// as crossed by an edge. Usually, `trace` writes the threshold with which it divided cells to the file. This
/// value is used for files that do not contain one.
constexpr float usual_contrast = 0.1F;

}  // namespace

SheetBuilder::SheetBuilder(const PixelLeaves& leaves, const SampleTrees& trees, const SheetKeys& keys,
                           const SampleHeader& header, const HighlightRule& rule, SheetMesh& out)
    : trees_(trees),
      keys_(keys),
      rule_(rule),
      out_(out),
      contrast_(header.subdivide_threshold > 0 ? static_cast<float>(header.subdivide_threshold)
                                               : usual_contrast),
      black_(static_cast<float>(0.05 * std::exp2(-header.exposure_stops))),
      pieces_(leaves, trees, keys, header) {}

void SheetBuilder::build(const SheetSquare& square) {
    square_ = square;
    pieces_.collect(square);
    pieces_.each_surface([&](std::uint32_t key, std::span<const LeafPiece* const> pieces) {
        key_ = keys_.keys[key];
        add_sheets(pieces);
    });
}

bool SheetBuilder::has_contrast(const LeafPiece& piece) const {
    for (std::size_t c = 0; c < 3; ++c) {
        if (is_contrast(node(piece.node[0]).rgb[c], node(piece.node[1]).rgb[c], node(piece.node[2]).rgb[c],
                        node(piece.node[3]).rgb[c]))
            return true;
    }
    return false;
}

std::uint8_t SheetBuilder::marks(const LeafPiece& piece) const {
    std::uint8_t out = RecordMark::all;
    for (const std::uint32_t n : piece.node) out &= node(n).mark;
    return out;
}

bool SheetBuilder::is_unsure_below(const LeafPiece& piece) const {
    for (std::size_t n = 0; n < 2; ++n) {
        std::uint8_t marked = RecordMark::all;
        for (const std::uint32_t corner : piece.node) marked &= node(corner).marks_below[n];
        if (marked != 0) return true;
        for (std::size_t c = 0; c < 3; ++c) {
            if (is_contrast(node(piece.node[0]).below[n][c], node(piece.node[1]).below[n][c],
                            node(piece.node[2]).below[n][c], node(piece.node[3]).below[n][c]))
                return true;
        }
    }
    return false;
}

// Returns whether four colours have a contrast [mitchell1987] above the threshold. `trace` divides pixels by
// the same rule.
bool SheetBuilder::is_contrast(float a, float b, float c, float d) const {
    const auto [low, high] = std::minmax({a, b, c, d});
    return high - low > contrast_ * (high + low + black_);
}

void SheetBuilder::add_sheets(std::span<const LeafPiece* const> pieces) {
    // A part of a pixel that shows one continuous surface. `low` and `high` are the smallest and the largest
    // inverse depth in this part, in 1/m. A pixel is divided into several parts if its depths differ too much
    // for one continuous surface.
    struct Part {
        float low = 0, high = 0;
        std::vector<const LeafPiece*> pieces;
    };
    thread_local std::vector<Part> parts;
    const auto covers = [](const Part& part, const LeafPiece& p) {
        for (std::size_t k = part.pieces.size(); k-- > 0;) {
            const LeafPiece& o = *part.pieces[k];
            if (o.leaf != p.leaf) return false;
            if (!o.maybe && !p.maybe && o.x < p.x + p.size && p.x < o.x + o.size && o.y < p.y + p.size &&
                p.y < o.y + o.size)
                return true;
        }
        return false;
    };
    drafts_used_ = 0;
    for (std::size_t i = 0; i < pieces.size();) {
        const int cell = pieces[i]->cell;
        std::size_t used = 0;
        for (; i < pieces.size() && pieces[i]->cell == cell; ++i) {
            const LeafPiece& p = *pieces[i];
            float low = node(p.node[0]).inverse_z, high = low;
            for (int k = 1; k < p.corners; ++k) {
                low = std::min(low, node(p.node[static_cast<std::size_t>(k)]).inverse_z);
                high = std::max(high, node(p.node[static_cast<std::size_t>(k)]).inverse_z);
            }
            std::size_t part = 0;
            while (part < used &&
                   (covers(parts[part], p) ||
                    !pieces_.continuous(std::min(low, parts[part].low), std::max(high, parts[part].high), 1)))
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
                d.cells.clear();
                d.fine.clear();
                d.coarse.clear();
                d.planes.clear();
                d.bends.clear();
                d.depth = 0;
                d.strays = {};
                d.number = static_cast<std::uint32_t>(out_.sheets.size() + s);
            }
            add_cell(s, parts[s].pieces, cell);
        }
    }
    emit();
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

std::uint32_t SheetBuilder::add_texel(std::size_t sheet, const LeafPiece& piece) {
    std::array<float, 3> rgb{};
    const std::size_t first_light = out_.bright.size();
    std::uint8_t children = 0;
    std::array<std::array<float, 3>, 2> below{};
    std::array<float, 2>& strays = drafts_[sheet].strays;
    Texel t;
    const float share = 1.0F / static_cast<float>(piece.corners);
    const bool whole = piece.corners == 4;
    const std::uint8_t marked = whole ? marks(piece) : std::uint8_t{0};
    for (int k = 0; k < piece.corners; ++k) {
        const TreeSurface& s = node(piece.node[static_cast<std::size_t>(k)]);
        std::array<float, 3> colour = s.rgb, excess{};
        for (std::size_t c = 0; c < 3; ++c) {
            excess[c] = std::max(0.0F, colour[c] - rule_.above);
            colour[c] -= excess[c];
        }
        for (std::size_t c = 0; c < 3; ++c) rgb[c] += share * colour[c];
        if (trees_.any_below) {
            for (std::size_t n = 0; n < 2; ++n) {
                for (std::size_t c = 0; c < 3; ++c) below[n][c] += share * s.below[n][c];
            }
        }
        children |= s.children;
        for (std::size_t n = 0; n < 2; ++n) strays[n] = std::max(strays[n], s.strays[n]);
        if (excess == std::array<float, 3>{}) continue;
        // Each corner represents the adjacent quarter of the leaf.
        const float area = share * piece.size * piece.size;
        const float x = piece.x + piece.size * (whole ? ((k & 1) != 0 ? 0.75F : 0.25F) : 0.5F),
                    y = piece.y + piece.size * (whole ? ((k & 2) != 0 ? 0.75F : 0.25F) : 0.5F);
        Highlight light;
        light.x = x + static_cast<float>(square_.x + piece.cell % SheetMesh::square_px);
        const int row = piece.cell / SheetMesh::square_px;
        light.y = y + static_cast<float>(square_.y + row);
        light.rgb = {area * excess[0], area * excess[1], area * excess[2]};
        light.area = area;
        light.w = s.path.bits() == 0 ? Mat2::isotropic(s.inverse_z) : s.w;
        light.inverse_z = s.inverse_z;
        light.bend = s.bend;
        light.sheet = drafts_[sheet].number;
        light.hides = piece.hides;
        out_.bright.push_back(light);
    }
    t.r = rgb[0];
    t.g = rgb[1];
    t.b = rgb[2];
    t.info = Texel::info_of(
        drafts_[sheet].number, children,
        (!whole || has_contrast(piece) || marked != 0 ? Texel::unsure_bit : 0U) |
            (children != 0 && (!whole || is_unsure_below(piece)) ? Texel::unsure_below_bit : 0U));
    out_.texels.push_back(t);
    note_bright(first_light, piece.size * piece.size);
    if (children != 0) {
        out_.below.resize(out_.texels.size());
        out_.below.back() = below;
    } else if (!out_.below.empty()) {
        out_.below.resize(out_.texels.size());
    }
    const double area = static_cast<double>(piece.size) * static_cast<double>(piece.size);
    for (std::size_t c = 0; c < 3; ++c) mean_.rgb[c] += area * static_cast<double>(rgb[c]);
    if (trees_.any_below) {
        for (std::size_t n = 0; n < 2; ++n) {
            for (std::size_t c = 0; c < 3; ++c) mean_.below[n][c] += area * static_cast<double>(below[n][c]);
        }
    }
    mean_.children |= children;
    mean_.may_have_gap |= (marked & RecordMark::gap) != 0;
    mean_.area += area;
    ++mean_.texels;
    return SheetNode::leaf | static_cast<std::uint32_t>(out_.texels.size() - 1);
}

void SheetBuilder::add_cell(std::size_t sheet, std::span<const LeafPiece* const> pieces, int cell) {
    Draft& draft = drafts_[sheet];
    tree_pieces_.assign(pieces.begin(), pieces.end());
    mean_ = {};
    const std::size_t first_light = out_.bright.size();
    draft.cells.push_back(cell);
    draft.fine.push_back(add_tree(sheet, tree_pieces_, 0, tree_pieces_.size(), 0, 0, 1, 0));
    draft.coarse.push_back(draft.fine.back());
    if (mean_.texels > 1 && mean_.area > 1 - 1e-9) {
        out_.texels.push_back(
            {static_cast<float>(mean_.rgb[0]), static_cast<float>(mean_.rgb[1]),
             static_cast<float>(mean_.rgb[2]),
             Texel::info_of(draft.number, mean_.children, mean_.may_have_gap ? Texel::unsure_bit : 0U)});
        note_bright(first_light, 1);
        if (!out_.below.empty()) {
            out_.below.resize(out_.texels.size());
            for (std::size_t n = 0; n < 2; ++n) {
                for (std::size_t c = 0; c < 3; ++c)
                    out_.below.back()[n][c] = static_cast<float>(mean_.below[n][c]);
            }
        }
        draft.coarse.back() = SheetNode::leaf | static_cast<std::uint32_t>(out_.texels.size() - 1);
    }
    std::array<CellPlane, 5> planes;
    if (out_.values == 1) {
        fit<1>(pieces, planes.data());
    } else {
        fit<5>(pieces, planes.data());
    }
    draft.planes.insert(draft.planes.end(), planes.begin(),
                        planes.begin() + static_cast<std::ptrdiff_t>(out_.values));
    if (!out_.has_w()) return;
    float bend = 0;
    for (const LeafPiece* p : pieces) {
        for (int k = 0; k < p->corners; ++k)
            bend = std::max(bend, node(p->node[static_cast<std::size_t>(k)]).bend);
    }
    draft.bends.push_back(bend);
}

std::uint32_t SheetBuilder::add_tree(std::size_t sheet, std::vector<const LeafPiece*>& pieces,
                                     std::size_t begin, std::size_t end, float x, float y, float size,
                                     int depth) {
    if (begin == end) return SheetNode::none;
    const auto at = [&](std::size_t i) { return pieces.begin() + static_cast<std::ptrdiff_t>(i); };
    if (pieces[begin]->size >= size) {
        const auto there = std::find_if(at(begin), at(end), [](const LeafPiece* p) { return !p->maybe; });
        return there != at(end) ? add_texel(sheet, **there) : SheetNode::maybe;
    }
    drafts_[sheet].depth = std::max(drafts_[sheet].depth, depth + 1);
    const float half = size / 2;
    const auto first = static_cast<std::uint32_t>(out_.nodes.size());
    out_.nodes.resize(out_.nodes.size() + 4, SheetNode::none);
    std::size_t from = begin;
    for (std::uint32_t k = 0; k < 4; ++k) {
        const float cx = (k & 1U) != 0 ? x + half : x, cy = (k & 2U) != 0 ? y + half : y;
        const auto inside = [&](const LeafPiece* p) {
            return p->x >= cx && p->x < cx + half && p->y >= cy && p->y < cy + half;
        };
        // The recursive call gets a contiguous part of `pieces`, the list of the surface's quadtree cells.
        // Therefore, the cells inside this quarter are moved together if they are not adjacent. This is
        // rarely needed, because the list is usually in quadtree order.
        auto middle = std::find_if_not(at(from), at(end), inside);
        if (std::any_of(middle, at(end), inside)) middle = std::stable_partition(middle, at(end), inside);
        const auto to = static_cast<std::size_t>(middle - pieces.begin());
        const std::uint32_t child = add_tree(sheet, pieces, from, to, cx, cy, half, depth + 1);
        out_.nodes[first + k] = child;
        from = to;
    }
    return first;
}

template <std::size_t values>
void SheetBuilder::fit(std::span<const LeafPiece* const> pieces, CellPlane* planes) const {
    double weight = 0, mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
    std::array<double, values> mean{}, vx{}, vy{};
    const auto each = [&](const auto& visit) {
        for (const LeafPiece* p : pieces) {
            if (p->maybe) continue;
            const double area = static_cast<double>(p->size) * static_cast<double>(p->size) / p->corners;
            for (int k = 0; k < p->corners; ++k) {
                const auto x = static_cast<double>(p->corners == 1 ? p->at_x
                                                   : (k & 1) != 0  ? p->x + p->size
                                                                   : p->x),
                           y = static_cast<double>(p->corners == 1 ? p->at_y
                                                   : (k & 2) != 0  ? p->y + p->size
                                                                   : p->y);
                const TreeSurface& s = node(p->node[static_cast<std::size_t>(k)]);
                std::array<double, values> v{static_cast<double>(s.inverse_z)};
                if constexpr (values == 5) {
                    v = {static_cast<double>(s.inverse_z), static_cast<double>(s.w.xx),
                         static_cast<double>(s.w.xy), static_cast<double>(s.w.yx),
                         static_cast<double>(s.w.yy)};
                }
                visit(area, x, y, v);
            }
        }
    };
    each([&](double a, double x, double y, const std::array<double, values>& v) {
        weight += a;
        mx += a * x;
        my += a * y;
        for (std::size_t i = 0; i < values; ++i) mean[i] += a * v[i];
    });
    mx /= weight;
    my /= weight;
    for (double& m : mean) m /= weight;
    each([&](double a, double x, double y, const std::array<double, values>& v) {
        xx += a * (x - mx) * (x - mx);
        xy += a * (x - mx) * (y - my);
        yy += a * (y - my) * (y - my);
        for (std::size_t i = 0; i < values; ++i) {
            vx[i] += a * (x - mx) * (v[i] - mean[i]);
            vy[i] += a * (y - my) * (v[i] - mean[i]);
        }
    });
    constexpr double ridge = 1e-3;  // px^2; keeps poorly determined slopes small
    xx += ridge * weight;
    yy += ridge * weight;
    const double det = xx * yy - xy * xy;
    for (std::size_t i = 0; i < values; ++i) {
        const double dx = (yy * vx[i] - xy * vy[i]) / det, dy = (xx * vy[i] - xy * vx[i]) / det;
        planes[i] = {static_cast<float>(mean[i] + dx * (0.5 - mx) + dy * (0.5 - my)), static_cast<float>(dx),
                     static_cast<float>(dy)};
    }
}

void SheetBuilder::emit() {
    for (std::size_t s = 0; s < drafts_used_; ++s) {
        const Draft& d = drafts_[s];
        int x0 = SheetMesh::square_px, x1 = 0;
        Sheet sheet;
        sheet.inverse_z_min = HUGE_VALF;
        sheet.inverse_z_max = -HUGE_VALF;
        for (std::size_t i = 0; i < d.cells.size(); ++i) {
            x0 = std::min(x0, d.cells[i] % SheetMesh::square_px);
            x1 = std::max(x1, d.cells[i] % SheetMesh::square_px + 1);
            const float z = d.planes[i * out_.values].value;
            sheet.inverse_z_min = std::min(sheet.inverse_z_min, z);
            sheet.inverse_z_max = std::max(sheet.inverse_z_max, z);
        }
        const int y0 = d.cells.front() / SheetMesh::square_px, y1 = d.cells.back() / SheetMesh::square_px + 1;
        sheet.key = key_;
        sheet.x = square_.x + x0;
        sheet.y = square_.y + y0;
        sheet.width = x1 - x0;
        sheet.height = y1 - y0;
        sheet.depth = d.depth;
        sheet.strays = d.strays;
        const std::size_t first = out_.fine.size();
        sheet.first_cell = static_cast<std::uint32_t>(first);
        const std::size_t end = first + static_cast<std::size_t>(sheet.width * sheet.height);
        out_.fine.resize(end, SheetNode::none);
        out_.coarse.resize(end, SheetNode::none);
        out_.planes.resize(end * out_.values);
        if (out_.has_w()) out_.bends.resize(end, 0.0F);
        for (std::size_t i = 0; i < d.cells.size(); ++i) {
            const std::size_t to =
                first + static_cast<std::size_t>((d.cells[i] / SheetMesh::square_px - y0) * sheet.width +
                                                 d.cells[i] % SheetMesh::square_px - x0);
            out_.fine[to] = d.fine[i];
            out_.coarse[to] = d.coarse[i];
            std::copy_n(d.planes.begin() + static_cast<std::ptrdiff_t>(i * out_.values), out_.values,
                        out_.planes.begin() + static_cast<std::ptrdiff_t>(to * out_.values));
            if (out_.has_w()) out_.bends[to] = d.bends[i];
        }
        out_.sheets.push_back(sheet);
    }
}

}  // namespace postlens
