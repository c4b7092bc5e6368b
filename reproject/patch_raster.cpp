#include "reproject/patch_raster.h"

#include <algorithm>
#include <cmath>

#include "core/multiversion.h"

namespace postlens {
namespace {

/// px by which a patch reaches beyond its sides, so that neighbours whose planes differ leave no crack.
constexpr float overlap = 0.02F;
/// Less is seen from the edge and has no area.
constexpr double smallest_area = 1e-6;

constexpr int lanes = SeenTile::edge;

/// A row of samples in the patch's own coordinates, and what it reads.
struct Row {
    float x = 0, y = 0, by_x = 0, by_y = 0;  ///< of the first sample, and from each to the next
    float width = 0, height = 0;             ///< of the patch
    float z = 0, z_x = 0, z_y = 0;           ///< inverse depth in its coordinates
    const std::uint32_t* roots = nullptr;
    std::int32_t stride = 0;
    const std::uint32_t* nodes = nullptr;
    int depth = 0;
    int count = 0;
};

struct Lanes {
    alignas(64) std::array<std::uint32_t, lanes> node;
    alignas(64) std::array<float, lanes> x, y, z;
};

/// Roots and depths of the samples.
POSTLENS_MULTIVERSION void find_roots(const Row& row, std::uint32_t* __restrict node, float* __restrict fx,
                                      float* __restrict fy, float* __restrict depth) {
    const float x_end = row.width + overlap, y_end = row.height + overlap;
    const float x_last = row.width - 1, y_last = row.height - 1;
    const std::uint32_t* __restrict roots = row.roots;
    const std::int32_t stride = row.stride;
    for (int i = 0; i < row.count; ++i) {
        const auto k = static_cast<float>(i);
        const float x = row.x + row.by_x * k, y = row.y + row.by_y * k;
        const bool inside = (x >= -overlap) & (x < x_end) & (y >= -overlap) & (y < y_end);
        // Above 0 the conversion rounds down.
        const auto ix = static_cast<std::int32_t>(std::min(std::max(x, 0.0F), x_last)),
                   iy = static_cast<std::int32_t>(std::min(std::max(y, 0.0F), y_last));
        const std::uint32_t root = roots[iy * stride + ix];
        node[i] = inside ? root : SheetNode::none;
        fx[i] = x - static_cast<float>(ix);
        fy[i] = y - static_cast<float>(iy);
        depth[i] = std::max(row.z + row.z_x * x + row.z_y * y, 0.0F);
    }
}

/// Drops what lies behind what is there already. False where nothing is left.
POSTLENS_MULTIVERSION bool drop_hidden(std::uint32_t* __restrict node, const float* __restrict depth,
                                       int count, const float* __restrict z) {
    std::uint32_t any = 0;
    for (int i = 0; i < count; ++i) {
        const bool nearer = (node[i] != SheetNode::none) & (depth[i] > z[i]);
        node[i] = nearer ? node[i] : SheetNode::none;
        any |= nearer ? 1U : 0U;
    }
    return any != 0;
}

/// One level down the quadtrees.
POSTLENS_MULTIVERSION void descend(const std::uint32_t* __restrict nodes, int count,
                                   std::uint32_t* __restrict node, float* __restrict fx,
                                   float* __restrict fy) {
    for (int i = 0; i < count; ++i) {
        const bool inner = (node[i] & SheetNode::leaf) == 0;  // `none` has that bit too
        const float x = fx[i] * 2, y = fy[i] * 2;
        const bool right = x >= 1, down = y >= 1;
        const std::uint32_t child = (inner ? node[i] : 0U) + (right ? 1U : 0U) + (down ? 2U : 0U);
        const std::uint32_t next = nodes[child];
        node[i] = inner ? next : node[i];
        fx[i] = inner ? (right ? x - 1 : x) : fx[i];
        fy[i] = inner ? (down ? y - 1 : y) : fy[i];
    }
}

POSTLENS_MULTIVERSION void keep_nearest(const std::uint32_t* __restrict node, const float* __restrict depth,
                                        int count, float* __restrict z, std::uint32_t* __restrict texel) {
    for (int i = 0; i < count; ++i) {
        const bool nearer = (node[i] != SheetNode::none) & (depth[i] > z[i]);
        z[i] = nearer ? depth[i] : z[i];
        texel[i] = nearer ? node[i] & ~SheetNode::leaf : texel[i];
    }
}

/// Pixels of a tile: [0, x_end) x [y_begin, y_end).
struct Part {
    int x_end = 0, y_begin = 0, y_end = 0;
};

/// Calls draw(k, lanes, count) for the runs of samples of a tile's part that a patch may cover: pixel index
/// of the first, and what is there.
template <typename Draw>
void for_each_run(const PatchMesh& mesh, const Patch& patch, const PatchPlace& place, const TilePlace& tile,
                  const Part& part, const SeenTile& out, const Draw& draw) {
    const RasterRect rect = covered(patch, place);
    // Sample (i, j) lies at origin + (i, j).
    const glm::dvec2 origin = glm::dvec2(tile.x, tile.y) + tile.sample;
    constexpr auto margin = static_cast<double>(overlap);
    const double i_low = std::max(0.0, std::ceil(rect.x_min - margin - origin.x)),
                 i_high = std::min(part.x_end - 1.0, std::floor(rect.x_max + margin - origin.x)),
                 j_low = std::max<double>(part.y_begin, std::ceil(rect.y_min - margin - origin.y)),
                 j_high = std::min(part.y_end - 1.0, std::floor(rect.y_max + margin - origin.y));
    if (!(i_low <= i_high && j_low <= j_high)) return;
    const int i0 = static_cast<int>(i_low), i1 = static_cast<int>(i_high), j0 = static_cast<int>(j_low),
              j1 = static_cast<int>(j_high);
    const glm::dmat2 back = glm::inverse(place.move);
    const SheetMesh& sheets = *mesh.sheets;
    const Sheet& sheet = mesh.sheet(patch);
    Row row;
    row.by_x = static_cast<float>(back[0].x);
    row.by_y = static_cast<float>(back[0].y);
    row.width = static_cast<float>(patch.width);
    row.height = static_cast<float>(patch.height);
    row.z = static_cast<float>(place.inverse_z.x);
    row.z_x = static_cast<float>(place.inverse_z.y);
    row.z_y = static_cast<float>(place.inverse_z.z);
    row.stride = sheet.width;
    row.roots = (patch.coarse ? sheets.coarse : sheets.fine).data() + sheet.first_cell +
                static_cast<std::size_t>(patch.y) * static_cast<std::size_t>(sheet.width) + patch.x;
    row.nodes = sheets.nodes.data();
    row.count = i1 - i0 + 1;
    Lanes lane;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled as far as it is read
    for (int j = j0; j <= j1; ++j) {
        const glm::dvec2 first = back * (origin + glm::dvec2(i0, j) - place.from);
        row.x = static_cast<float>(first.x);
        row.y = static_cast<float>(first.y);
        find_roots(row, lane.node.data(), lane.x.data(), lane.y.data(), lane.z.data());
        const std::size_t k = static_cast<std::size_t>(j) * SeenTile::edge + static_cast<std::size_t>(i0);
        if (!drop_hidden(lane.node.data(), lane.z.data(), row.count, out.inverse_z.data() + k)) continue;
        for (int level = 0; level < patch.depth; ++level)
            descend(row.nodes, row.count, lane.node.data(), lane.x.data(), lane.y.data());
        draw(k, lane, row.count);
    }
}

}  // namespace

void draw_patch(const PatchMesh& mesh, const Patch& patch, const PatchPlace& place, const TilePlace& tile,
                SeenTile& out) {
    if (!(glm::determinant(place.move) > smallest_area)) return;
    const Part all{tile.width, 0, tile.height};
    for_each_run(mesh, patch, place, tile, all, out, [&](std::size_t k, const Lanes& lane, int count) {
        keep_nearest(lane.node.data(), lane.z.data(), count, out.inverse_z.data() + k, out.texel.data() + k);
    });
}

void find_wanted(const SheetMesh& in_mesh, const SeenTile& in, std::uint8_t bounce, WantedPixels& wanted,
                 SeenTile& out) {
    out.inverse_z.fill(HUGE_VALF);
    out.texel.fill(SeenTile::no_texel);
    int x0 = SeenTile::edge, x1 = 0, y0 = SeenTile::edge, y1 = 0;
    for (int y = 0; y < SeenTile::edge; ++y) {
        for (int x = 0; x < SeenTile::edge; ++x) {
            const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
            if (in.texel[k] == SeenTile::no_texel) continue;
            const Texel& t = in_mesh.texels[in.texel[k]];
            if ((t.children() & bounce) == 0) continue;
            wanted.in[k] = in_mesh.sheets[t.sheet()].key.id;
            out.inverse_z[k] = SeenTile::nothing;
            x0 = std::min(x0, x);
            x1 = std::max(x1, x + 1);
            y0 = std::min(y0, y);
            y1 = y + 1;
        }
    }
    const bool any = x0 < x1;
    wanted.x_begin = any ? x0 : 0;
    wanted.x_end = any ? x1 : 0;
    wanted.y_begin = any ? y0 : 0;
    wanted.y_end = any ? y1 : 0;
}

void draw_patch_in(const PatchMesh& mesh, const Patch& patch, const PatchPlace& place, const TilePlace& tile,
                   const WantedPixels& wanted, SeenTile& out) {
    const auto& m = place.move;
    const double torn = std::max({std::abs(m[0].x), std::abs(m[0].y), std::abs(m[1].x), std::abs(m[1].y)});
    if (!(torn <= largest_torn_px) || !(std::abs(glm::determinant(m)) > smallest_area)) return;
    const std::uint32_t parent_id = mesh.sheet(patch).key.parent_id;
    // Not from wanted.x_begin on: where a run begins decides how its places are rounded.
    const Part part{wanted.x_end, wanted.y_begin, wanted.y_end};
    for_each_run(mesh, patch, place, tile, part, out, [&](std::size_t first, const Lanes& lane, int count) {
        for (int i = 0; i < count; ++i) {
            const auto n = static_cast<std::size_t>(i);
            const std::size_t k = first + n;
            if (lane.node[n] == SheetNode::none || wanted.in[k] != parent_id) continue;
            out.inverse_z[k] = lane.z[n];
            out.texel[k] = lane.node[n] & ~SheetNode::leaf;
        }
    });
}

}  // namespace postlens
