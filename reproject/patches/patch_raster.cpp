#include "reproject/patches/patch_raster.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "core/multiversion.h"

#ifdef POSTLENS_FOR_INSTRUCTION_SET
#include <immintrin.h>
#endif

namespace postlens {
namespace {

/// Least factor by which the reprojection to a view may scale the area of a patch (planar part of a surface).
/// With a smaller factor, the patch is seen edge-on and contains no sample of a pixel, so it is not drawn.
constexpr double smallest_area = 1e-6;

/// Number of neighbouring samples of an image row that SIMD code processes together. It is `few_lanes` for a
/// patch (planar part of a surface) that is at most 8 samples wide in the image, because more lanes would be
/// empty.
constexpr int most_lanes = 16, few_lanes = 8;
static_assert(SeenTile::slack >= most_lanes);

/// The pixels of a tile that a patch (planar part of a surface) may cover, row by row, and the positions of
/// their samples on the patch, in px from its corner. From each sample to the next one on its right, the
/// position changes by (by_x, by_y).
struct Run {
    glm::dmat2 back{1};    ///< from the raster to the patch's coordinates
    glm::dvec2 origin{0};  ///< raster px of sample (0, 0)
    glm::dvec2 from{0};    ///< raster px of the patch's corner
    int i0 = 0, count = 0, j0 = 0, j1 = 0;
    float by_x = 0, by_y = 0;
    float width = 0, height = 0;  ///< size of the patch
    float overlap = 0;
    float z = 0, z_x = 0, z_y = 0;  ///< inverse depth at the patch's corner, and its slopes along x and y
    const std::uint32_t* roots = nullptr;
    std::int32_t stride = 0;
    const std::uint32_t* nodes = nullptr;
    int depth = 0;
    std::uint32_t mark = 0;  ///< bits that are added to every texel number
    /// Returns the position of the leftmost sample in pixel row j.
    [[nodiscard]] glm::vec2 first(int j) const { return back * (origin + glm::dvec2(i0, j) - from); }
    [[nodiscard]] std::size_t pixel(int j) const {
        return static_cast<std::size_t>(j) * SeenTile::edge + static_cast<std::size_t>(i0);
    }
};

struct Lanes {
    alignas(64) std::array<std::int32_t, most_lanes> cell;
    alignas(64) std::array<float, most_lanes> x, y, z;
};

/// The arrays of a SeenTile, beginning at some pixel.
struct Seen {
    float* z;
    std::uint32_t* texel;
    float* maybe;
    [[nodiscard]] Seen from(std::size_t k) const { return {z + k, texel + k, maybe + k}; }
};
Seen seen_in(SeenTile& tile) {
    return {tile.inverse_z.data(), tile.texel.data(), tile.maybe_inverse_z.data()};
}

/// Each patch is drawn slightly beyond its edges, to avoid cracks between neighbours. Beyond its edges, its
/// inverse depth is multiplied by this factor, so that it lies behind the neighbouring patch.
constexpr float in_overlap = 1 - 1e-3F;

/// A table of 1 << n, because some SIMD instruction sets cannot shift each element by a different number of
/// bits.
alignas(64) constexpr std::uint32_t bit[most_lanes] = {
    1,       1U << 1, 1U << 2,  1U << 3,  1U << 4,  1U << 5,  1U << 6,  1U << 7,
    1U << 8, 1U << 9, 1U << 10, 1U << 11, 1U << 12, 1U << 13, 1U << 14, 1U << 15};

// Forces inlining of functions into drawing loops, because each loop is compiled for several SIMD instruction
// sets.
#define POSTLENS_PART [[gnu::always_inline]] inline

/// Tests in which of `lanes` successive pixels of an image row a patch (planar part of a surface) is visible.
/// Bit n of the result is set if it is visible at the sample of pixel `begin` + n.
/// - `there`: inverse depths of the surfaces drawn before
/// - `lane`: receives the positions of the samples on the patch and the patch's inverse depths there
template <int lanes>
POSTLENS_PART std::uint32_t find_samples(const Run& run, glm::vec2 first, int begin,
                                         const float* __restrict there, Lanes& lane) {
    const float overlap = run.overlap, x_end = run.width + overlap, y_end = run.height + overlap;
    const float x_last = run.width - 1, y_last = run.height - 1;
    const std::int32_t stride = run.stride, count = run.count;
    const float by_x = run.by_x, by_y = run.by_y, z = run.z, z_x = run.z_x, z_y = run.z_y;
    std::int32_t* __restrict cell = lane.cell.data();
    float* __restrict fx = lane.x.data(), * __restrict fy = lane.y.data(), * __restrict depth = lane.z.data();
    std::uint32_t found = 0;
#pragma GCC unroll 1
    for (int n = 0; n < lanes; ++n) {
        const std::int32_t i = begin + n;
        const auto k = static_cast<float>(i);
        const float x = first.x + by_x * k, y = first.y + by_y * k;
        // For values of 0 or more the conversion rounds down.
        const auto ix = static_cast<std::int32_t>(std::min(std::max(x, 0.0F), x_last)),
                   iy = static_cast<std::int32_t>(std::min(std::max(y, 0.0F), y_last));
        const bool own = (x >= 0) & (x < run.width) & (y >= 0) & (y < run.height);
        const float mine = std::max(z + z_x * x + z_y * y, 0.0F) * (own ? 1.0F : in_overlap);
        cell[n] = iy * stride + ix;
        fx[n] = x - static_cast<float>(ix);
        fy[n] = y - static_cast<float>(iy);
        depth[n] = mine;
        const bool here =
            (i < count) & (x >= -overlap) & (x < x_end) & (y >= -overlap) & (y < y_end) & (mine > there[n]);
        found |= here ? bit[n] : 0U;
    }
    return found;
}

template <int lanes>
POSTLENS_PART std::uint32_t wanted_in(const std::uint32_t* __restrict in, std::uint32_t id) {
    std::uint32_t found = 0;
#pragma GCC unroll 1
    for (int n = 0; n < lanes; ++n) found |= in[n] == id ? bit[n] : 0U;
    return found;
}

/// Finds a recorded colour in the quadtree that stores the colours of a pixel. The search starts at the cell
/// `node` and returns the leaf (undivided cell) that contains the position (x, y), from 0 to 1 across the
/// cell.
POSTLENS_PART std::uint32_t leaf_at(const Run& run, std::uint32_t node, float x, float y) {
    for (int level = 0; level < run.depth && (node & SheetNode::leaf) == 0; ++level) {
        x *= 2;
        y *= 2;
        const bool right = x >= 1, down = y >= 1;
        node = run.nodes[node + (right ? 1U : 0U) + (down ? 2U : 0U)];
        x -= right ? 1.0F : 0.0F;
        y -= down ? 1.0F : 0.0F;
    }
    return node;
}

/// Draws a patch (planar part of a surface) in some pixels of a row that begins at `seen`: in pixel n if bit
/// n of `found` is set. Pixels in which the patch has no recorded colour are left unchanged. `lane` contains
/// the position of each pixel's sample on the patch, and its inverse depth.
POSTLENS_PART void draw_samples(const Run& run, const Lanes& lane, std::uint32_t found, const Seen& seen) {
    for (; found != 0; found &= found - 1) {
        const auto n = static_cast<std::size_t>(std::countr_zero(found));
        const std::uint32_t node = leaf_at(run, run.roots[lane.cell[n]], lane.x[n], lane.y[n]);
        if (SheetNode::empty(node)) {
            // A possible surface, whose edge is unknown, is not drawn. Only its inverse depth is kept.
            if (node == SheetNode::maybe) seen.maybe[n] = std::max(seen.maybe[n], lane.z[n]);
            continue;
        }
        seen.z[n] = lane.z[n];
        seen.texel[n] = (node & ~SheetNode::leaf) | run.mark;
    }
}

/// The pixels of a tile in which a patch is drawn. If `in` is null, these are all pixels. Otherwise, `in`
/// stores a number for each pixel, for example the id of the mirror that the pixel shows, and the patch is
/// drawn only in pixels whose number is `id`.
struct Where {
    const std::uint32_t* in = nullptr;
    std::uint32_t id = 0;
    template <int lanes>
    [[nodiscard]] POSTLENS_PART std::uint32_t samples(std::size_t k) const {
        return in == nullptr ? ~0U : wanted_in<lanes>(in + k, id);
    }
};

template <int lanes>
POSTLENS_PART void draw_run(const Run& run, const Where& where, const Seen& seen) {
    Lanes lane;  // NOLINT(cppcoreguidelines-pro-type-member-init): find_samples fills it
    for (int j = run.j0; j <= run.j1; ++j) {
        const glm::vec2 first = run.first(j);
        for (int i = 0; i < run.count; i += lanes) {
            const std::size_t k = run.pixel(j) + static_cast<std::size_t>(i);
            const std::uint32_t found = find_samples<lanes>(run, first, i, seen.z + k, lane);
            draw_samples(run, lane, found & where.samples<lanes>(k), seen.from(k));
        }
    }
}

POSTLENS_PART void draw_runs(const Run& run, const Where& where, const Seen& seen) {
    if (run.count <= few_lanes) {
        draw_run<few_lanes>(run, where, seen);
    } else {
        draw_run<most_lanes>(run, where, seen);
    }
}

#ifdef POSTLENS_FOR_INSTRUCTION_SET
POSTLENS_FOR_INSTRUCTION_SET("default") void draw_rows(const Run& run, const Where& where, const Seen& seen) {
    draw_runs(run, where, seen);
}
POSTLENS_FOR_INSTRUCTION_SET("arch=x86-64-v3")
void draw_rows(const Run& run, const Where& where, const Seen& seen) {
    draw_runs(run, where, seen);
}

/// Draws those samples of `found` (one bit per sample) whose recorded pixel is not divided, and therefore has
/// only one colour. Returns the bits of the other samples. `lanes` must be that of find_samples, because
/// otherwise a wide load of `lane` would have to wait for two narrower stores.
template <int lanes>
POSTLENS_FOR_INSTRUCTION_SET("arch=x86-64-v4")
POSTLENS_PART std::uint32_t
    draw_undivided(const Run& run, const Lanes& lane, std::uint32_t found, const Seen& seen) {
    // Signed, only leaves are less than SheetNode::maybe.
    constexpr int leaf = std::bit_cast<int>(SheetNode::leaf), maybe = std::bit_cast<int>(SheetNode::maybe);
    const int mark = std::bit_cast<int>(run.mark);
    if constexpr (lanes == 16) {
        const auto wanted = static_cast<__mmask16>(found);
        const __m512i leaves = _mm512_set1_epi32(leaf), cell = _mm512_load_si512(lane.cell.data()),
                      node = _mm512_mask_i32gather_epi32(leaves, wanted, cell, run.roots, 4);
        const __mmask16 drawn = _mm512_mask_cmplt_epi32_mask(wanted, node, _mm512_set1_epi32(maybe));
        _mm512_mask_storeu_ps(seen.z, drawn, _mm512_load_ps(lane.z.data()));
        _mm512_mask_storeu_epi32(seen.texel, drawn,
                                 _mm512_or_si512(_mm512_xor_si512(node, leaves), _mm512_set1_epi32(mark)));
        return found & ~std::uint32_t{drawn};
    } else {
        static_assert(lanes == 8);
        const auto wanted = static_cast<__mmask8>(found);
        const auto* cells = reinterpret_cast<const __m256i*>(lane.cell.data());
        const __m256i leaves = _mm256_set1_epi32(leaf),
                      node = _mm256_mmask_i32gather_epi32(leaves, wanted, _mm256_load_si256(cells), run.roots,
                                                          4);
        const __mmask8 drawn = _mm256_mask_cmplt_epi32_mask(wanted, node, _mm256_set1_epi32(maybe));
        _mm256_mask_storeu_ps(seen.z, drawn, _mm256_load_ps(lane.z.data()));
        _mm256_mask_storeu_epi32(seen.texel, drawn,
                                 _mm256_or_si256(_mm256_xor_si256(node, leaves), _mm256_set1_epi32(mark)));
        return found & ~std::uint32_t{drawn};
    }
}

template <int lanes>
POSTLENS_FOR_INSTRUCTION_SET("arch=x86-64-v4")
POSTLENS_PART void draw_run_together(const Run& run, const Where& where, const Seen& seen) {
    Lanes lane;  // NOLINT(cppcoreguidelines-pro-type-member-init): find_samples fills it
    for (int j = run.j0; j <= run.j1; ++j) {
        const glm::vec2 first = run.first(j);
        for (int i = 0; i < run.count; i += lanes) {
            const std::size_t k = run.pixel(j) + static_cast<std::size_t>(i);
            const std::uint32_t found =
                find_samples<lanes>(run, first, i, seen.z + k, lane) & where.samples<lanes>(k);
            if (found == 0) continue;
            draw_samples(run, lane, draw_undivided<lanes>(run, lane, found, seen.from(k)), seen.from(k));
        }
    }
}

POSTLENS_FOR_INSTRUCTION_SET("arch=x86-64-v4")
void draw_rows(const Run& run, const Where& where, const Seen& seen) {
    if (run.count <= few_lanes) {
        draw_run_together<few_lanes>(run, where, seen);
    } else {
        draw_run_together<most_lanes>(run, where, seen);
    }
}
#else
void draw_rows(const Run& run, const Where& where, const Seen& seen) {
    draw_runs(run, where, seen);
}
#endif

#undef POSTLENS_PART

/// Bounding box of pixels, added row by row.
class PartOfPixels {
  public:
    void add(int x, int y) {
        if (part_.y_end == 0) part_.y_begin = y;
        part_.x_begin = std::min(part_.x_begin, x);
        part_.x_end = std::max(part_.x_end, x + 1);
        part_.y_end = y + 1;
    }
    [[nodiscard]] TilePart part() const { return part_.empty() ? TilePart{} : part_; }

  private:
    TilePart part_{SeenTile::edge, 0, 0, 0};
};

/// Finds the pixels of a tile that a patch (planar part of a surface) may cover. Considers only pixels inside
/// the rectangle `part`. Returns nothing if there are none.
std::optional<Run> run_of(const PatchMesh& mesh, const Patch& patch, const PatchPlace& place,
                          const TilePlace& tile, const TilePart& part) {
    const RasterRect rect = covered(patch, place);
    // Sample (i, j) lies at origin + (i, j).
    const glm::dvec2 origin = glm::dvec2(tile.x, tile.y) + tile.sample;
    const auto margin = static_cast<double>(mesh.overlap_px);
    const double i_low = std::max<double>(part.x_begin, std::ceil(rect.x_min - margin - origin.x)),
                 i_high = std::min(part.x_end - 1.0, std::floor(rect.x_max + margin - origin.x)),
                 j_low = std::max<double>(part.y_begin, std::ceil(rect.y_min - margin - origin.y)),
                 j_high = std::min(part.y_end - 1.0, std::floor(rect.y_max + margin - origin.y));
    if (!(i_low <= i_high && j_low <= j_high)) return std::nullopt;
    const SheetMesh& sheets = *mesh.sheets;
    const Sheet& sheet = mesh.sheet(patch);
    const glm::dmat2 back = glm::inverse(place.move);
    return Run{.back = back,
               .origin = origin,
               .from = place.from,
               .i0 = static_cast<int>(i_low),
               .count = static_cast<int>(i_high) - static_cast<int>(i_low) + 1,
               .j0 = static_cast<int>(j_low),
               .j1 = static_cast<int>(j_high),
               .by_x = static_cast<float>(back[0].x),
               .by_y = static_cast<float>(back[0].y),
               .width = static_cast<float>(patch.width),
               .height = static_cast<float>(patch.height),
               .overlap = mesh.overlap_px,
               .z = static_cast<float>(place.inverse_z.x),
               .z_x = static_cast<float>(place.inverse_z.y),
               .z_y = static_cast<float>(place.inverse_z.z),
               .roots = (patch.coarse ? sheets.coarse : sheets.fine).data() + sheet.first_cell +
                        static_cast<std::size_t>(patch.y) * static_cast<std::size_t>(sheet.width) + patch.x,
               .stride = sheet.width,
               .nodes = sheets.nodes.data(),
               .depth = patch.depth,
               .mark = patch.bent ? SeenTile::bent : 0U};
}

}  // namespace

void draw_patch(const PatchMesh& mesh, const Patch& patch, const PatchPlace& place, const TilePlace& tile,
                SeenTile& out) {
    if (!(glm::determinant(place.move) > smallest_area)) return;
    const auto run = run_of(mesh, patch, place, tile, {0, tile.width, 0, tile.height});
    if (run) draw_rows(*run, {}, seen_in(out));
}

TilePart find_parents(const PatchMesh& mesh, const SeenTile& seen, const TilePlace& at) {
    PartOfPixels found;
    for (int y = 0; y < at.height; ++y) {
        const std::uint32_t* texel = seen.texel.data() + static_cast<std::size_t>(y) * SeenTile::edge;
        for (int x = 0; x < at.width; ++x) {
            if (texel[x] != SeenTile::no_texel && mesh.drawn_children(texel[x]) != 0) found.add(x, y);
        }
    }
    return found.part();
}

void find_wanted(const PatchMesh& in_mesh, const SeenTile& in, std::uint8_t bounce, const TilePart& part,
                 const std::function<std::uint32_t(std::size_t pixel)>& around, WantedPixels& wanted,
                 SeenTile& out) {
    PartOfPixels found;
    wanted.blocks = {};
    wanted.any_gaps = false;
    for (int y = part.y_begin; y < part.y_end; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * SeenTile::edge;
        // Clears this row of the tile. The inverse depths are set to infinity, so that the depth test lets
        // nothing be drawn, and in the wanted pixels then to `nothing`. The whole row is cleared, because
        // draw_patch_in also tests pixels to the left of `part`.
        std::fill_n(out.inverse_z.data() + row, SeenTile::edge, HUGE_VALF);
        std::fill_n(out.texel.data() + row, SeenTile::edge, SeenTile::no_texel);
        std::fill_n(out.maybe_inverse_z.data() + row, SeenTile::edge, SeenTile::nothing);
        for (int x = part.x_begin; x < part.x_end; ++x) {
            const std::size_t k = row + static_cast<std::size_t>(x);
            if (in.texel[k] == SeenTile::no_texel) {
                if (!around || in.inverse_z[k] != SeenTile::nothing) continue;
                wanted.in[k] = WantedPixels::in_gap(around(k));
                wanted.any_gaps = true;
            } else {
                const std::uint32_t texel = in.texel[k] & ~SeenTile::bent;
                if ((in_mesh.drawn_children(texel) & bounce) == 0) continue;
                wanted.in[k] = in_mesh.id_of(texel);
            }
            out.inverse_z[k] = SeenTile::nothing;
            found.add(x, y);
            wanted.blocks.add(x, y);
        }
    }
    wanted.part = found.part();
}

void draw_patch_in(const PatchMesh& mesh, const Patch& patch, const PatchPlace& place, const TilePlace& tile,
                   const WantedPixels& wanted, SeenTile& out) {
    const auto& m = place.move;
    const double torn = std::max({std::abs(m[0].x), std::abs(m[0].y), std::abs(m[1].x), std::abs(m[1].y)});
    if (!(torn <= largest_torn_px) || !(std::abs(glm::determinant(m)) > smallest_area)) return;
    const std::uint32_t parent_id = mesh.sheet(patch).key.parent_id;
    // Each row begins where the patch or the tile begins, even if only pixels farther right are wanted. The
    // positions of its samples are computed from the first one, so their rounding would otherwise depend on
    // `wanted.part`.
    const auto run =
        run_of(mesh, patch, place, tile, {0, wanted.part.x_end, wanted.part.y_begin, wanted.part.y_end});
    if (!run) return;
    draw_rows(*run, {wanted.in.data(), parent_id}, seen_in(out));
    if (!wanted.any_gaps || patch.bent) return;
    draw_rows(*run, {wanted.in.data(), WantedPixels::in_gap(parent_id)}, seen_in(out));
}

}  // namespace postlens
