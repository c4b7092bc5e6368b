#include "reproject/light_field.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "core/threads.h"
#include "reproject/tile_raster.h"

namespace postlens {
namespace {

/// Two meshes show one surface where ids agree and depths do within this share.
constexpr float same_depth = 0.02F;

struct MovingBlock {
    std::uint32_t block = 0;
    std::uint8_t mark = 0;
    RasterRect swept;  ///< by all views, and where it was recorded
};

/// What of a mesh stands still in every view, and what does not.
struct SortedMesh {
    std::vector<std::vector<std::uint32_t>> still;  ///< blocks, by row of tiles that they touch
    std::vector<MovingBlock> moving;
};

struct Sums {
    std::vector<double> r, g, b, known;
};

/// Everything that one thread draws with.
struct Workplace {
    std::vector<std::unique_ptr<TileBuffer>> still;  ///< by mesh
    std::vector<char> still_drawn;
    TileBuffer view[2];
    DrawScratch scratch;
    std::vector<std::vector<std::uint32_t>> moving, resting;  ///< by mesh: blocks that may meet the tile
    std::array<double, TileBuffer::pixels> r{}, g{}, b{}, known{};
    std::array<std::uint8_t, TileBuffer::pixels> touched{};
};

class Field {
  public:
    explicit Field(const LightField& field) : field_(field) {
        order_.resize(field.views.size());
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
            const glm::dvec2 p = field.views[a].sample, q = field.views[b].sample;
            return p.y != q.y ? p.y < q.y : p.x < q.x;
        });
        for (const FieldView& v : field.views) total_ += v.weight;
        find_still_classes();
        meshes_.resize(field.meshes.size());
        for (std::size_t m = 0; m < meshes_.size(); ++m) sort_blocks(m);
    }

    FieldPicture picture() {
        FieldPicture out;
        const auto n = static_cast<std::size_t>(field_.width) * static_cast<std::size_t>(field_.height);
        out.image = Image(field_.width, field_.height);
        out.touched.assign(n, 0);
        out.unknown.assign(n, 0);
        const int columns = tiles(field_.width), rows = tiles(field_.height);
        parallel_for(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), [&](std::size_t i) {
            thread_local std::unique_ptr<Workplace> w;
            if (!w) w = std::make_unique<Workplace>();
            const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
            constexpr int edge = TileBuffer::edge;
            if (field_.crop && !field_.crop->meets(column * edge, row * edge, edge, edge)) return;
            draw_tile(column * edge, row * edge, *w, out);
        });
        return out;
    }

  private:
    static int tiles(int px) { return (px + TileBuffer::edge - 1) / TileBuffer::edge; }

    void find_still_classes() {
        still_class_.assign(field_.motion_classes, 1);
        for (const FieldView& v : field_.views) {
            for (const auto& use : v.uses) {
                if (field_.meshes[use.mesh]->has_velocities()) continue;
                for (std::size_t c = 0; c < field_.motion_classes; ++c) {
                    if (!use.maps[c].identity()) still_class_[c] = 0;
                }
            }
        }
    }

    [[nodiscard]] bool stands_still(const SampleMesh& mesh, const MeshBlock& block) const {
        if (!mesh.has_velocities()) return still_class_[field_.motion_class(block.id)] != 0;
        return block.vx_min == 0 && block.vx_max == 0 && block.vy_min == 0 && block.vy_max == 0;
    }

    static RasterRect rect_of(const SampleMesh& mesh, const MeshBlock& block, const FieldView::Use& use,
                              std::size_t motion_class) {
        return mesh.has_velocities() ? covered_rect(block, use.elapsed)
                                     : covered_rect(block, use.maps[motion_class]);
    }

    void sort_blocks(std::size_t m) {
        const SampleMesh& mesh = *field_.meshes[m];
        SortedMesh& out = meshes_[m];
        out.still.resize(static_cast<std::size_t>(tiles(field_.height)));
        for (std::uint32_t b = 0; b < mesh.blocks.size(); ++b) {
            const MeshBlock& block = mesh.blocks[b];
            if (!stands_still(mesh, block)) {
                out.moving.push_back({b, field_.class_marks[field_.motion_class(block.id)], {}});
                continue;
            }
            const int first = std::max(0, static_cast<int>(std::floor(block.y_min)) / TileBuffer::edge),
                      last = std::min(tiles(field_.height) - 1,
                                      static_cast<int>(std::floor(block.y_max)) / TileBuffer::edge);
            if (block.y_max < 0) continue;
            for (int row = first; row <= last; ++row) out.still[static_cast<std::size_t>(row)].push_back(b);
        }
        parallel_for(
            out.moving.size(),
            [&](std::size_t i) {
                MovingBlock& moving = out.moving[i];
                const MeshBlock& block = mesh.blocks[moving.block];
                const std::size_t c = field_.motion_class(block.id);
                moving.swept = covered_rect(block, RasterMap());
                for (const FieldView& v : field_.views) {
                    for (const auto& use : v.uses) {
                        if (use.mesh == m) moving.swept.add(rect_of(mesh, block, use, c));
                    }
                }
            },
            64);
    }

    void draw_tile(int x0, int y0, Workplace& w, FieldPicture& out) {
        const int width = std::min(TileBuffer::edge, field_.width - x0),
                  height = std::min(TileBuffer::edge, field_.height - y0);
        const std::size_t count = meshes_.size();
        w.moving.resize(count);
        w.resting.resize(count);
        w.still_drawn.assign(count, 0);
        bool any = false;
        for (std::size_t m = 0; m < count; ++m) {
            w.moving[m].clear();
            for (const MovingBlock& b : meshes_[m].moving) {
                if (!b.swept.meets(x0, x0 + width, y0, y0 + height)) continue;
                w.moving[m].push_back(b.block);
                any = any || (b.mark & field_.wanted_marks) != 0;
            }
        }
        if (!any) return;
        while (w.still.size() < count) w.still.push_back(std::make_unique<TileBuffer>());
        for (std::size_t m = 0; m < count; ++m) find_resting(m, x0, y0, width, height, w);
        for (auto* sum : {&w.r, &w.g, &w.b, &w.known}) sum->fill(0);
        w.touched.fill(0);
        mark_recorded(x0, y0, width, height, w);
        for (std::size_t k = 0; k < order_.size(); ++k) {
            const FieldView& v = field_.views[order_[k]];
            if (k > 0 && v.sample != field_.views[order_[k - 1]].sample) w.still_drawn.assign(count, 0);
            draw_view(v, {x0 + v.sample.x, y0 + v.sample.y, width, height}, w);
        }
        store(x0, y0, width, height, w, out);
    }

    void find_resting(std::size_t m, int x0, int y0, int width, int height, Workplace& w) const {
        const SampleMesh& mesh = *field_.meshes[m];
        w.resting[m].clear();
        for (const std::uint32_t b : meshes_[m].still[static_cast<std::size_t>(y0 / TileBuffer::edge)]) {
            if (covered_rect(mesh.blocks[b], RasterMap()).meets(x0, x0 + width, y0, y0 + height))
                w.resting[m].push_back(b);
        }
    }

    // Pixels in which a mesh shows something that moves: their recorded colours are not what the views see.
    void mark_recorded(int x0, int y0, int width, int height, Workplace& w) const {
        for (std::size_t m = 0; m < meshes_.size(); ++m) {
            const SampleMesh& mesh = *field_.meshes[m];
            for (const std::uint32_t b : w.moving[m]) {
                const MeshBlock& block = mesh.blocks[b];
                const std::uint8_t mark = field_.class_marks[field_.motion_class(block.id)];
                if (!covered_rect(block, RasterMap()).meets(x0, x0 + width, y0, y0 + height)) continue;
                for (std::uint32_t q = 0; q < block.quads; ++q) {
                    const auto& v = mesh.quads[block.first_quad + q].vertex;
                    // As recorded a quad lies within one pixel, its first vertex at the upper left.
                    const int x = static_cast<int>(std::floor(mesh.x[block.first_vertex + v[0]])) - x0,
                              y = static_cast<int>(std::floor(mesh.y[block.first_vertex + v[0]])) - y0;
                    if (x >= 0 && y >= 0 && x < width && y < height)
                        w.touched[static_cast<std::size_t>(y) * TileBuffer::edge +
                                  static_cast<std::size_t>(x)] |= mark;
                }
            }
        }
    }

    void draw_still(std::size_t m, const TileView& at, Workplace& w) const {
        if (w.still_drawn[m] != 0) return;
        w.still_drawn[m] = 1;
        w.still[m]->clear();
        const SampleMesh& mesh = *field_.meshes[m];
        for (const std::uint32_t b : w.resting[m])
            draw_block(mesh, mesh.blocks[b], RasterMap(), 0, at, w.scratch, *w.still[m]);
    }

    void draw_view(const FieldView& v, const TileView& at, Workplace& w) const {
        for (std::size_t u = 0; u < v.uses.size(); ++u) {
            const FieldView::Use& use = v.uses[u];
            const SampleMesh& mesh = *field_.meshes[use.mesh];
            draw_still(use.mesh, at, w);
            w.view[u] = *w.still[use.mesh];
            for (const std::uint32_t b : w.moving[use.mesh]) {
                const MeshBlock& block = mesh.blocks[b];
                const std::size_t c = field_.motion_class(block.id);
                if (!rect_of(mesh, block, use, c)
                         .meets(at.x, at.x + at.width - 1, at.y, at.y + at.height - 1))
                    continue;
                if (mesh.has_velocities()) {
                    draw_block(mesh, block, use.elapsed, field_.class_marks[c], at, w.scratch, w.view[u]);
                } else {
                    draw_block(mesh, block, use.maps[c], field_.class_marks[c], at, w.scratch, w.view[u]);
                }
            }
        }
        if (v.uses.size() == 2) blend(v, at, w);
        const TileBuffer& seen = w.view[0];
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                const auto k = static_cast<std::size_t>(y) * TileBuffer::edge + static_cast<std::size_t>(x);
                if (seen.inverse_z[k] < 0) {
                    w.touched[k] = 0xFF;
                    continue;
                }
                w.r[k] += v.weight * static_cast<double>(seen.r[k]);
                w.g[k] += v.weight * static_cast<double>(seen.g[k]);
                w.b[k] += v.weight * static_cast<double>(seen.b[k]);
                w.known[k] += v.weight;
                w.touched[k] |= seen.mark[k];
            }
        }
    }

    // Both views of the same instant in one: the nearer surface, and of the same surface the mean.
    static void blend(const FieldView& v, const TileView& at, Workplace& w) {
        TileBuffer& a = w.view[0];
        const TileBuffer& b = w.view[1];
        const auto share_a = static_cast<float>(v.uses[0].share),
                   share_b = static_cast<float>(v.uses[1].share);
        for (int y = 0; y < at.height; ++y) {
            for (int x = 0; x < at.width; ++x) {
                const auto k = static_cast<std::size_t>(y) * TileBuffer::edge + static_cast<std::size_t>(x);
                const float za = a.inverse_z[k], zb = b.inverse_z[k];
                if (zb < 0) continue;
                const bool same =
                    za >= 0 && a.id[k] == b.id[k] && std::abs(za - zb) <= same_depth * std::max(za, zb);
                if (same) {
                    a.r[k] = share_a * a.r[k] + share_b * b.r[k];
                    a.g[k] = share_a * a.g[k] + share_b * b.g[k];
                    a.b[k] = share_a * a.b[k] + share_b * b.b[k];
                } else if (zb > za) {
                    a.inverse_z[k] = zb;
                    a.r[k] = b.r[k];
                    a.g[k] = b.g[k];
                    a.b[k] = b.b[k];
                }
                a.mark[k] |= b.mark[k];
            }
        }
    }

    void store(int x0, int y0, int width, int height, const Workplace& w, FieldPicture& out) const {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const auto k = static_cast<std::size_t>(y) * TileBuffer::edge + static_cast<std::size_t>(x);
                const std::size_t p =
                    static_cast<std::size_t>(y0 + y) * static_cast<std::size_t>(field_.width) +
                    static_cast<std::size_t>(x0 + x);
                out.touched[p] = w.touched[k];
                out.unknown[p] = static_cast<float>(std::max(0.0, 1 - w.known[k] / total_));
                if (w.known[k] <= 0) {
                    out.unknown[p] = 1;
                    continue;
                }
                float* rgb = out.image.pixel(x0 + x, y0 + y);
                rgb[0] = static_cast<float>(w.r[k] / w.known[k]);
                rgb[1] = static_cast<float>(w.g[k] / w.known[k]);
                rgb[2] = static_cast<float>(w.b[k] / w.known[k]);
            }
        }
    }

    const LightField& field_;
    std::vector<std::size_t> order_;
    double total_ = 0;
    std::vector<char> still_class_;
    std::vector<SortedMesh> meshes_;
};

}  // namespace

FieldPicture light_field(const LightField& field) {
    return Field(field).picture();
}

void lay_over(Image& image, const FieldPicture& seen, std::uint8_t marks, const Image& behind) {
    for (std::size_t k = 0; k < seen.touched.size(); ++k) {
        if ((seen.touched[k] & marks) == 0) continue;
        const float gap = seen.unknown[k];
        for (std::size_t c = 0; c < 3; ++c) {
            float& to = image.rgb[3 * k + c];
            to = seen.image.rgb[3 * k + c];
            if (gap > 0) to = (1 - gap) * to + gap * behind.rgb[3 * k + c];
        }
    }
}

}  // namespace postlens
