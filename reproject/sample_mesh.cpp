#include "reproject/sample_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/memory.h"
#include "core/threads.h"
#include "reproject/sample_surfaces.h"

namespace postlens {
namespace {

/// A corner's share of a quad in a leaf: all four vertices, or the quarter next to one corner.
struct LeafPiece {
    std::uint32_t id = 0;
    std::array<std::uint32_t, 4> surface{};  ///< whole: of the corners; quarter: [0] only
    float x = 0, y = 0, size = 0;            ///< of the leaf
    int quarter = -1;                        ///< which corner; -1: whole
};

/// What one square of the raster holds, with vertices and quads numbered from 0.
struct TilePart {
    std::vector<MeshBlock> blocks;
    std::vector<float> x, y, inverse_z;
    std::vector<std::array<float, 3>> rgb;
    std::vector<MicroQuad> quads;
};

class TileBuilder {
  public:
    TileBuilder(const PixelLeaves& leaves, const SampleSurfaces& surfaces, double tangent_per_px,
                bool perspective)
        : leaves_(leaves), surfaces_(surfaces), per_px_(tangent_per_px), perspective_(perspective) {}

    /// Leaves of the pixels [first, last) of each of `rows` rows of `width`.
    void build(std::size_t first, std::size_t last, std::size_t rows, std::size_t width, TilePart& out) {
        pieces_.clear();
        for (std::size_t row = 0; row < rows; ++row) {
            const std::uint32_t begin = leaves_.leaf_offsets[row * width + first],
                                end = leaves_.leaf_offsets[row * width + last];
            for (std::uint32_t i = begin; i < end; ++i) add_leaf(leaves_.leaves[i]);
        }
        std::stable_sort(pieces_.begin(), pieces_.end(),
                         [](const LeafPiece& a, const LeafPiece& b) { return a.id < b.id; });
        local_.resize(surfaces_.surfaces.size());
        for (std::size_t i = 0; i < pieces_.size();) {
            std::size_t end = i;
            while (end < pieces_.size() && pieces_[end].id == pieces_[i].id) ++end;
            add_block(i, end, out);
            i = end;
        }
    }

  private:
    struct Local {
        std::uint64_t stamp = 0;
        std::uint32_t vertex = 0;
    };

    [[nodiscard]] std::uint32_t count(std::uint32_t sample) const {
        return surfaces_.offsets[sample + 1] - surfaces_.offsets[sample];
    }
    [[nodiscard]] const LayerSurface& surface(std::uint32_t i) const { return surfaces_.surfaces[i]; }

    /// Whether the four can be one surface, by how steep it would be.
    [[nodiscard]] bool continuous(const std::array<std::uint32_t, 4>& s, float size) const {
        const auto [low, high] = std::minmax({surface(s[0]).inverse_z, surface(s[1]).inverse_z,
                                              surface(s[2]).inverse_z, surface(s[3]).inverse_z});
        return is_one_surface(low, high, static_cast<double>(size) * per_px_, perspective_);
    }

    void add_leaf(const Leaf& leaf) {
        const auto& c = leaf.corner;
        const PointSample& at = leaves_.points.samples[c[0]];
        const std::array<std::uint32_t, 4> first{surfaces_.offsets[c[0]], surfaces_.offsets[c[1]],
                                                 surfaces_.offsets[c[2]], surfaces_.offsets[c[3]]};
        const std::array<std::uint32_t, 4> counts{count(c[0]), count(c[1]), count(c[2]), count(c[3])};
        if (counts == std::array<std::uint32_t, 4>{1, 1, 1, 1} && same_id(first)) {  // by far the most
            add_group(surface(first[0]).id, first, at, leaf.size);
            return;
        }
        // Pairs of (id, which of its occurrences from the front): those that the corners share make quads.
        used_.assign(static_cast<std::size_t>(counts[0]) + counts[1] + counts[2] + counts[3], 0);
        std::size_t base = 0;
        for (std::size_t k = 0; k < 4; base += counts[k], ++k) {
            for (std::uint32_t i = 0; i < counts[k]; ++i) {
                if (used_[base + i] != 0) continue;
                std::array<std::uint32_t, 4> group{none, none, none, none};
                const std::uint32_t id = surface(first[k] + i).id;
                std::size_t other_base = 0;
                for (std::size_t m = 0; m < 4; other_base += counts[m], ++m) {
                    if (m < k) continue;  // all of its ids are used up
                    for (std::uint32_t n = 0; n < counts[m]; ++n) {
                        if (used_[other_base + n] != 0 || surface(first[m] + n).id != id) continue;
                        used_[other_base + n] = 1;
                        group[m] = first[m] + n;
                        break;
                    }
                }
                add_group(id, group, at, leaf.size);
            }
        }
    }

    static constexpr std::uint32_t none = 0xFFFFFFFFU;

    [[nodiscard]] bool same_id(const std::array<std::uint32_t, 4>& s) const {
        const std::uint32_t id = surface(s[0]).id;
        return surface(s[1]).id == id && surface(s[2]).id == id && surface(s[3]).id == id;
    }

    void add_group(std::uint32_t id, const std::array<std::uint32_t, 4>& s, const PointSample& at,
                   float size) {
        const bool whole = s[0] != none && s[1] != none && s[2] != none && s[3] != none;
        if (whole && continuous(s, size)) {
            pieces_.push_back({id, s, at.x, at.y, size, -1});
            return;
        }
        for (int k = 0; k < 4; ++k) {
            const std::uint32_t corner = s[static_cast<std::size_t>(k)];
            if (corner != none) pieces_.push_back({id, {corner}, at.x, at.y, size, k});
        }
    }

    std::uint32_t add_vertex(float x, float y, const LayerSurface& s, TilePart& out) {
        out.x.push_back(x);
        out.y.push_back(y);
        out.inverse_z.push_back(s.inverse_z);
        out.rgb.push_back({s.r, s.g, s.b});
        return static_cast<std::uint32_t>(out.x.size() - 1);
    }

    void add_block(std::size_t begin, std::size_t end, TilePart& out) {
        MeshBlock block;
        block.id = pieces_[begin].id;
        block.first_vertex = static_cast<std::uint32_t>(out.x.size());
        block.first_quad = static_cast<std::uint32_t>(out.quads.size());
        ++stamp_;
        for (std::size_t i = begin; i < end; ++i) add_piece(pieces_[i], block.first_vertex, out);
        block.vertices = static_cast<std::uint32_t>(out.x.size()) - block.first_vertex;
        block.quads = static_cast<std::uint32_t>(out.quads.size()) - block.first_quad;
        const auto range = [&](const std::vector<float>& v, float& low, float& high) {
            const auto [a, b] = std::minmax_element(v.begin() + block.first_vertex, v.end());
            low = *a;
            high = *b;
        };
        range(out.x, block.x_min, block.x_max);
        range(out.y, block.y_min, block.y_max);
        range(out.inverse_z, block.inverse_z_min, block.inverse_z_max);
        out.blocks.push_back(block);
    }

    void add_piece(const LeafPiece& p, std::uint32_t first_vertex, TilePart& out) {
        MicroQuad quad;
        const auto corner_x = [&](int k, float low, float size) { return (k & 1) != 0 ? low + size : low; };
        if (p.quarter < 0) {
            for (int k = 0; k < 4; ++k) {
                const std::uint32_t s = p.surface[static_cast<std::size_t>(k)];
                Local& local = local_[s];
                if (local.stamp != stamp_) {
                    local.stamp = stamp_;
                    local.vertex =
                        add_vertex(corner_x(k, p.x, p.size), corner_x(k >> 1, p.y, p.size), surface(s), out) -
                        first_vertex;
                }
                quad.vertex[static_cast<std::size_t>(k)] = local.vertex;
            }
        } else {
            const float half = p.size / 2;
            const float x0 = corner_x(p.quarter, p.x, half), y0 = corner_x(p.quarter >> 1, p.y, half);
            for (int k = 0; k < 4; ++k) {
                quad.vertex[static_cast<std::size_t>(k)] =
                    add_vertex(corner_x(k, x0, half), corner_x(k >> 1, y0, half), surface(p.surface[0]),
                               out) -
                    first_vertex;
            }
        }
        out.quads.push_back(quad);
    }

    const PixelLeaves& leaves_;
    const SampleSurfaces& surfaces_;
    double per_px_;
    bool perspective_;
    std::vector<LeafPiece> pieces_;
    std::vector<char> used_;
    std::vector<Local> local_;  ///< by surface: its vertex in the block being made
    std::uint64_t stamp_ = 0;
};

void append(TilePart&& part, SampleMesh& mesh) {
    const auto vertices = static_cast<std::uint32_t>(mesh.x.size());
    const auto quads = static_cast<std::uint32_t>(mesh.quads.size());
    for (MeshBlock b : part.blocks) {
        b.first_vertex += vertices;
        b.first_quad += quads;
        mesh.blocks.push_back(b);
    }
    const auto move_all = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
    move_all(part.x, mesh.x);
    move_all(part.y, mesh.y);
    move_all(part.inverse_z, mesh.inverse_z);
    move_all(part.rgb, mesh.rgb);
    move_all(part.quads, mesh.quads);
}

}  // namespace

SampleMesh sample_mesh(const SampleFileReader& file, std::size_t instant) {
    const SampleHeader& h = file.header();
    SampleMesh mesh;
    mesh.time_s = file.instant_s(instant);
    mesh.x_begin = file.x_begin();
    mesh.x_end = file.x_end() - 1;
    mesh.y_begin = file.y_begin();
    mesh.y_end = file.y_end() - 1;
    // A vertex and a quad at most for every record, and as much again while vectors grow.
    require_memory(file.record_count() * 2 * (sizeof(MicroQuad) + 6 * sizeof(float)),
                   "the mesh of micro-quads");
    const bool perspective = h.projection == Projection::perspective;
    const double per_px = across_per_px(h);
    constexpr int tile = SampleMesh::block_px;
    constexpr int tiles_per_task = 8;
    RecordBand band;
    PixelLeaves leaves;
    SampleSurfaces surfaces;
    for (int y = mesh.y_begin; y < mesh.y_end; y += tile) {
        const int y_end = std::min(y + tile, mesh.y_end);
        file.read(y, y_end + 1, band, instant);
        find_leaves(band, y, y_end, leaves);
        find_surfaces(band, leaves.points, y, surfaces);
        const auto width = static_cast<std::size_t>(band.width());
        const std::size_t tiles = (width - 1 + tile - 1) / tile;
        const std::size_t tasks = (tiles + tiles_per_task - 1) / tiles_per_task;
        std::vector<TilePart> parts(tasks);
        parallel_for(tasks, [&](std::size_t t) {
            TileBuilder builder(leaves, surfaces, per_px, perspective);
            const std::size_t last = std::min((t + 1) * tiles_per_task, tiles);
            for (std::size_t k = t * tiles_per_task; k < last; ++k) {
                builder.build(k * tile, std::min((k + 1) * tile, width - 1),
                              static_cast<std::size_t>(y_end - y), width, parts[t]);
            }
        });
        for (TilePart& part : parts) append(std::move(part), mesh);
    }
    return mesh;
}

}  // namespace postlens
