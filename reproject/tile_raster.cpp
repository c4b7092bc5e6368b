#include "reproject/tile_raster.h"

#include <algorithm>
#include <cmath>

#include "core/multiversion.h"

namespace postlens {
namespace {

constexpr float behind = -2;  ///< inverse depth of a vertex that the map brings behind the camera

/// A triangle reaches this share of itself beyond its sides, so that no ray slips through between neighbours
/// whose shared side has a corner of a third on it.
constexpr float overlap = 1e-3F;
/// px by which the search for samples goes beyond a quad, so that the above comes to bear.
constexpr float margin = 2e-4F;
/// In a cell: the vertex lies within the margin of a column of samples, or of a row.
constexpr std::uint32_t near_column = 0x8000U, near_row = near_column << 16U;

POSTLENS_MULTIVERSION void transform(const float* __restrict x, const float* __restrict y,
                                     const float* __restrict inverse_z, std::size_t count, const double* m,
                                     double x0, double y0, float* __restrict to_x, float* __restrict to_y,
                                     float* __restrict to_inverse_z) {
    // m: rows X, Y, D of the map, each for (x, y, 1, 1/z).
    for (std::size_t i = 0; i < count; ++i) {
        const auto px = static_cast<double>(x[i]), py = static_cast<double>(y[i]),
                   pz = static_cast<double>(inverse_z[i]);
        const double d = m[8] * px + m[9] * py + m[10] + m[11] * pz;
        const double scale = 1 / d;
        const double u = (m[0] * px + m[1] * py + m[2] + m[3] * pz) * scale - x0;
        const double v = (m[4] * px + m[5] * py + m[6] + m[7] * pz) * scale - y0;
        const bool ahead = d > 0;
        to_x[i] = ahead ? static_cast<float>(u) : 0;
        to_y[i] = ahead ? static_cast<float>(v) : 0;
        to_inverse_z[i] = ahead ? static_cast<float>(pz * scale) : behind;
    }
}

POSTLENS_MULTIVERSION void shift(const float* __restrict x, std::size_t count, double x0,
                                 float* __restrict to) {
    for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<float>(static_cast<double>(x[i]) - x0);
}

POSTLENS_MULTIVERSION void move(const float* __restrict x, const float* __restrict v, std::size_t count,
                                double elapsed, double x0, float* __restrict to) {
    for (std::size_t i = 0; i < count; ++i)
        to[i] = static_cast<float>(static_cast<double>(x[i]) + elapsed * static_cast<double>(v[i]) - x0);
}

/// Which samples a vertex lies between: column in the lower half, row in the upper.
POSTLENS_MULTIVERSION void find_cells(const float* __restrict x, const float* __restrict y, std::size_t count,
                                      std::uint32_t* __restrict cell) {
    for (std::size_t i = 0; i < count; ++i) {
        // Above 0 the conversion rounds down; far outside one place is as good as another.
        const float cx = std::min(std::max(x[i] + 256.0F, 0.0F), 1023.0F),
                    cy = std::min(std::max(y[i] + 256.0F, 0.0F), 1023.0F);
        const auto ix = static_cast<std::int32_t>(cx), iy = static_cast<std::int32_t>(cy);
        const float rest_x = cx - static_cast<float>(ix), rest_y = cy - static_cast<float>(iy);
        const bool by_column = rest_x < margin || rest_x > 1 - margin,
                   by_row = rest_y < margin || rest_y > 1 - margin;
        cell[i] = static_cast<std::uint32_t>(ix) | (static_cast<std::uint32_t>(iy) << 16U) |
                  (by_column ? near_column : 0U) | (by_row ? near_row : 0U);
    }
}

/// The quads that reach across a column of samples and across a row of them: few of those that are smaller
/// than a pixel. Returns their number.
POSTLENS_MULTIVERSION std::size_t find_hits(const MicroQuad* __restrict quads, std::uint32_t count,
                                            const std::uint32_t* __restrict cell,
                                            std::uint32_t* __restrict hit) {
    std::size_t hits = 0;
    for (std::uint32_t q = 0; q < count; ++q) {
        const auto& v = quads[q].vertex;
        const std::uint32_t a = cell[v[0]];
        const std::uint32_t b = cell[v[1]], c = cell[v[2]], d = cell[v[3]];
        const std::uint32_t across =
            (a ^ b) | (a ^ c) | (a ^ d) | ((a | b | c | d) & (near_column | near_row));
        hit[hits] = q;
        hits += (across & 0xFFFFU) != 0 && (across >> 16U) != 0 ? 1 : 0;
    }
    return hits;
}

void make_room(const MeshBlock& block, DrawScratch& s) {
    const std::size_t n = block.vertices;
    if (s.hit.size() < block.quads) s.hit.resize(block.quads);
    if (s.x.size() < n) {
        s.cell.resize(n);
        s.x.resize(n);
        s.y.resize(n);
        s.inverse_z.resize(n);
    }
}

void transform_block(const SampleMesh& mesh, const MeshBlock& block, const RasterMap& map,
                     const TileView& view, DrawScratch& s) {
    const std::size_t n = block.vertices;
    make_room(block, s);
    const float *x = mesh.x.data() + block.first_vertex, *y = mesh.y.data() + block.first_vertex,
                *z = mesh.inverse_z.data() + block.first_vertex;
    if (map.identity()) {
        shift(x, n, view.x, s.x.data());
        shift(y, n, view.y, s.y.data());
        std::copy_n(z, n, s.inverse_z.data());
    } else if (map.projection() == Projection::perspective) {
        double m[12];
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 4; ++column) m[4 * row + column] = map.matrix()[column][row];
        }
        transform(x, y, z, n, m, view.x, view.y, s.x.data(), s.y.data(), s.inverse_z.data());
    } else {
        for (std::size_t i = 0; i < n; ++i) {
            const auto p =
                map({static_cast<double>(x[i]), static_cast<double>(y[i]), static_cast<double>(z[i])});
            s.x[i] = p ? static_cast<float>(p->x - view.x) : 0;
            s.y[i] = p ? static_cast<float>(p->y - view.y) : 0;
            s.inverse_z[i] = p ? static_cast<float>(p->inverse_z) : behind;
        }
    }
}

int ceil_of(float v) {
    const int i = static_cast<int>(v);
    return i + (static_cast<float>(i) < v ? 1 : 0);
}
int floor_of(float v) {
    const int i = static_cast<int>(v);
    return i - (static_cast<float>(i) > v ? 1 : 0);
}

/// Shares of the corners of triangle a b c at a point; false outside, and for a triangle turned over.
struct Triangle {
    float ax, ay, ux, uy, vx, vy, inverse_area;  // u = b - a, v = c - a
    bool drawn;
    Triangle(float ax_, float ay_, float bx, float by, float cx, float cy)
        : ax(ax_),
          ay(ay_),
          ux(bx - ax_),
          uy(by - ay_),
          vx(cx - ax_),
          vy(cy - ay_),
          inverse_area(0),
          drawn(false) {
        const float area = ux * vy - uy * vx;
        drawn = area > 1e-12F;
        inverse_area = 1 / area;
    }
    [[nodiscard]] bool shares(float x, float y, float& b, float& c) const {
        if (!drawn) return false;
        const float dx = x - ax, dy = y - ay;
        b = (dx * vy - dy * vx) * inverse_area;
        c = (ux * dy - uy * dx) * inverse_area;
        return b >= -overlap && c >= -overlap && b + c <= 1 + overlap;
    }
};

/// Draws a block whose vertices lie in the scratch, where the view has them.
void draw_quads(const SampleMesh& mesh, const MeshBlock& block, std::uint8_t mark, const TileView& view,
                DrawScratch& s, TileBuffer& out) {
    const float *x = s.x.data(), *y = s.y.data(), *z = s.inverse_z.data();
    const std::array<float, 3>* rgb = mesh.rgb.data() + block.first_vertex;
    const auto last_x = static_cast<float>(view.width - 1), last_y = static_cast<float>(view.height - 1);
    const auto* quads = mesh.quads.data() + block.first_quad;
    find_cells(x, y, block.vertices, s.cell.data());
    const std::size_t hits = find_hits(quads, block.quads, s.cell.data(), s.hit.data());
    for (std::size_t h = 0; h < hits; ++h) {
        const auto& v = quads[s.hit[h]].vertex;
        const float x0 = x[v[0]], x1 = x[v[1]], x2 = x[v[2]], x3 = x[v[3]];
        const float y0 = y[v[0]], y1 = y[v[1]], y2 = y[v[2]], y3 = y[v[3]];
        const float x_low = std::max(0.0F, std::min(std::min(x0, x1), std::min(x2, x3)) - margin),
                    x_high = std::min(last_x, std::max(std::max(x0, x1), std::max(x2, x3)) + margin);
        const float y_low = std::max(0.0F, std::min(std::min(y0, y1), std::min(y2, y3)) - margin),
                    y_high = std::min(last_y, std::max(std::max(y0, y1), std::max(y2, y3)) + margin);
        if (!(x_low <= x_high && y_low <= y_high)) continue;
        const int i0 = ceil_of(x_low), i1 = floor_of(x_high), j0 = ceil_of(y_low), j1 = floor_of(y_high);
        if (i0 > i1 || j0 > j1) continue;
        const float z0 = z[v[0]], z1 = z[v[1]], z2 = z[v[2]], z3 = z[v[3]];
        if (std::min(std::min(z0, z1), std::min(z2, z3)) < 0) continue;
        const Triangle upper(x0, y0, x1, y1, x3, y3), lower(x0, y0, x3, y3, x2, y2);
        for (int j = j0; j <= j1; ++j) {
            for (int i = i0; i <= i1; ++i) {
                const auto px = static_cast<float>(i), py = static_cast<float>(j);
                float b = 0, c = 0;
                std::uint32_t vb = v[1], vc = v[3];
                float zb = z1, zc = z3;
                if (!upper.shares(px, py, b, c)) {
                    if (!lower.shares(px, py, b, c)) continue;
                    vb = v[3];
                    vc = v[2];
                    zb = z3;
                    zc = z2;
                }
                const float a = 1 - b - c;
                const float depth = std::max(0.0F, a * z0 + b * zb + c * zc);
                const auto k = static_cast<std::size_t>(j) * TileBuffer::edge + static_cast<std::size_t>(i);
                if (depth <= out.inverse_z[k]) continue;
                const auto &p0 = rgb[v[0]], &p1 = rgb[vb], &p2 = rgb[vc];
                out.inverse_z[k] = depth;
                out.r[k] = a * p0[0] + b * p1[0] + c * p2[0];
                out.g[k] = a * p0[1] + b * p1[1] + c * p2[1];
                out.b[k] = a * p0[2] + b * p1[2] + c * p2[2];
                out.id[k] = block.id;
                out.mark[k] = mark;
            }
        }
    }
}

}  // namespace

RasterRect covered_rect(const MeshBlock& block, const RasterMap& map) {
    RasterRect out;
    if (map.identity()) {
        out.x_min = static_cast<double>(block.x_min);
        out.x_max = static_cast<double>(block.x_max);
        out.y_min = static_cast<double>(block.y_min);
        out.y_max = static_cast<double>(block.y_max);
        return out;
    }
    // The map takes straight lines to straight lines: the corners of the box bound what is in it.
    for (int k = 0; k < 8; ++k) {
        const auto p = map({static_cast<double>((k & 1) != 0 ? block.x_max : block.x_min),
                            static_cast<double>((k & 2) != 0 ? block.y_max : block.y_min),
                            static_cast<double>((k & 4) != 0 ? block.inverse_z_max : block.inverse_z_min)});
        constexpr double everywhere = std::numeric_limits<double>::infinity();
        if (!p) return {-everywhere, everywhere, -everywhere, everywhere};
        out.add({p->x, p->x, p->y, p->y});
    }
    return out;
}

RasterRect covered_rect(const MeshBlock& block, double elapsed) {
    const auto reach = [elapsed](float low, float high, float v_low, float v_high, double& out_low,
                                 double& out_high) {
        const double a = elapsed * static_cast<double>(v_low), b = elapsed * static_cast<double>(v_high);
        out_low = static_cast<double>(low) + std::min(a, b);
        out_high = static_cast<double>(high) + std::max(a, b);
    };
    RasterRect out;
    reach(block.x_min, block.x_max, block.vx_min, block.vx_max, out.x_min, out.x_max);
    reach(block.y_min, block.y_max, block.vy_min, block.vy_max, out.y_min, out.y_max);
    return out;
}

void draw_block(const SampleMesh& mesh, const MeshBlock& block, const RasterMap& map, std::uint8_t mark,
                const TileView& view, DrawScratch& s, TileBuffer& out) {
    transform_block(mesh, block, map, view, s);
    draw_quads(mesh, block, mark, view, s, out);
}

void draw_block(const SampleMesh& mesh, const MeshBlock& block, double elapsed, std::uint8_t mark,
                const TileView& view, DrawScratch& s, TileBuffer& out) {
    const std::size_t n = block.vertices;
    make_room(block, s);
    move(mesh.x.data() + block.first_vertex, mesh.vx.data() + block.first_vertex, n, elapsed, view.x,
         s.x.data());
    move(mesh.y.data() + block.first_vertex, mesh.vy.data() + block.first_vertex, n, elapsed, view.y,
         s.y.data());
    std::copy_n(mesh.inverse_z.data() + block.first_vertex, n, s.inverse_z.data());
    draw_quads(mesh, block, mark, view, s, out);
}

}  // namespace postlens
