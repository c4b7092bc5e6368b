// Rasterises patches (nearly planar parts of surfaces) into an image tile with a depth test. Each pixel has
// one sample.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>

#include "reproject/patches/patches.h"

namespace postlens {

struct TilePlace;

/// The nearest surface in each pixel of a tile, as seen in one view (image for one lens point and instant).
struct SeenTile {
    static constexpr int edge = 64;  ///< px
    static constexpr std::size_t pixels = static_cast<std::size_t>(edge) * edge;
    static constexpr float nothing = -1;  ///< inverse depth of a pixel without a recorded surface
    static constexpr std::uint32_t no_texel = 0xFFFFFFFFU;
    /// Bit of a pixel's element in `texel`, the array that stores which recorded colour each pixel shows. If
    /// it is set, the pixel shows a reflection or refraction that cannot be reprojected accurately, because
    /// its image moves too nonlinearly with the lens point (Patch::bent).
    static constexpr std::uint32_t bent = 0x80000000U;

    /// Padding for SIMD code, which reads 16 values at a time, even beyond the end of the last row.
    static constexpr std::size_t slack = 16;

    alignas(64) std::array<float, pixels + slack> inverse_z{};
    alignas(64) std::array<std::uint32_t, pixels> texel{};
    /// For each pixel: inverse depth, in 1/m, of the nearest surface that possibly covers the pixel. The
    /// records contain no exact edges. Where an edge may lie, a cell of the surface is marked
    /// SheetNode::maybe, and this inverse depth is stored instead of drawing the cell. -1 if there is none.
    alignas(64) std::array<float, pixels> maybe_inverse_z{};

    void clear() {
        inverse_z.fill(nothing);
        texel.fill(no_texel);
        maybe_inverse_z.fill(nothing);
    }
    /// Clears only the pixels in use.
    void clear(const TilePlace& at);
    /// Returns whether a nearer surface, whose exact edge is unknown, may hide the pixel's visible surface.
    [[nodiscard]] bool may_be_hidden(std::size_t pixel) const {
        return maybe_inverse_z[pixel] > inverse_z[pixel];
    }
};

/// Describes the tile (square of the image) that is drawn: its position, its size, and the position within
/// each pixel at which surfaces are sampled. The tile may be smaller than SeenTile::edge, for instance at the
/// border of the image.
struct TilePlace {
    int x = 0, y = 0;                                     ///< raster px of the first pixel
    int width = SeenTile::edge, height = SeenTile::edge;  ///< pixels in use
    glm::dvec2 sample{0.5};                               ///< px
};

template <typename Values>
void fill_pixels(const TilePlace& at, Values& values, const typename Values::value_type& value) {
    for (int y = 0; y < at.height; ++y) std::fill_n(values.begin() + y * SeenTile::edge, at.width, value);
}

inline void SeenTile::clear(const TilePlace& at) {
    fill_pixels(at, inverse_z, nothing);
    fill_pixels(at, texel, no_texel);
    fill_pixels(at, maybe_inverse_z, nothing);
}

/// The pixels [x_begin, x_end) x [y_begin, y_end) of a tile, relative to the tile's corner.
struct TilePart {
    int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
    [[nodiscard]] bool empty() const { return x_begin >= x_end || y_begin >= y_end; }
    [[nodiscard]] std::size_t pixels() const {
        return static_cast<std::size_t>(x_end - x_begin) * static_cast<std::size_t>(y_end - y_begin);
    }
};

/// A coarse set of pixels of a 64 x 64 px tile: one bit per block of 8 x 8 px. It quickly excludes rectangles
/// that contain no pixel of the set.
class PixelBlocks {
  public:
    void add(int x, int y) { blocks_ |= std::uint64_t{1} << (y / block_px * across + x / block_px); }
    /// Returns whether a rectangle may contain a pixel of the set, to which `add` adds pixels. The set stores
    /// only which blocks of 8 x 8 px contain such pixels. So the result is whether the rectangle [x0, x1] x
    /// [y0, y1], in px from the tile's corner, touches any of these blocks.
    [[nodiscard]] bool any_in(float x0, float x1, float y0, float y1) const {
        constexpr auto end = static_cast<float>(SeenTile::edge);
        if (!(x1 >= 0 && x0 < end && y1 >= 0 && y0 < end)) return false;
        const auto block = [](float at) {
            return static_cast<unsigned>(std::clamp(at, 0.0F, end - 1)) / block_px;
        };
        // Returns eight bits of which the bits `from` to `to` are set.
        const auto bits = [](unsigned from, unsigned to) { return (2U << to) - (1U << from); };
        const std::uint64_t columns = bits(block(x0), block(x1)) * std::uint64_t{0x0101010101010101};
        const unsigned top = block(y0), bottom = block(y1);
        const std::uint64_t rows =
            (~std::uint64_t{0} >> (across * (across - 1 - bottom))) >> (across * top) << (across * top);
        return (blocks_ & columns & rows) != 0;
    }

  private:
    static constexpr unsigned across = 8, block_px = SeenTile::edge / across;
    std::uint64_t blocks_ = 0;
};

/// Draws a patch (planar part of a surface) into a tile. `place` is the affine map that reprojects the patch.
/// A depth test keeps the nearest surface in each pixel; of equally near surfaces, the first one stays. Back
/// faces are not drawn, because they are not recorded.
void draw_patch(const PatchMesh& mesh, const Patch& patch, const PatchPlace& place, const TilePlace& tile,
                SeenTile& out);

/// The pixels that show a mirror or glass. The surfaces seen in it by reflection or transmission are drawn
/// only in these pixels.
struct WantedPixels {
    std::array<std::uint32_t, SeenTile::pixels + SeenTile::slack>
        in{};       ///< for each pixel that needs the surface, id of the object that reflects or transmits it
    TilePart part;  ///< bounding box of these pixels; empty if there are none
    PixelBlocks blocks;
    /// Whether the mirror or glass is not recorded in some of these pixels. There, the nearest visible object
    /// in which it would be seen is known. So for such a pixel, the array `in` stores in_gap(id of this
    /// object) instead of the id of an object that reflects or transmits.
    bool any_gaps = false;
    [[nodiscard]] static std::uint32_t in_gap(std::uint32_t id) { return ~id; }
};

/// Finds the pixels of `part` in which a reflected or transmitted node must be drawn, and writes them to
/// `wanted`. These are the pixels whose texel in `in` has a child node for `bounce` (child_bit).
///
/// `in`: the parent nodes that the view sees, with texels of `in_mesh`.
/// `part`: must contain all such pixels.
/// `around`: returns the nearest visible ancestor's id where the parent is not recorded. If empty, such
/// pixels are left out. `out`: the found pixels are cleared. Other pixels in the rows of `part` get an
/// infinite inverse depth, so nothing can be drawn there.
void find_wanted(const PatchMesh& in_mesh, const SeenTile& in, std::uint8_t bounce, const TilePart& part,
                 const std::function<std::uint32_t(std::size_t pixel)>& around, WantedPixels& wanted,
                 SeenTile& out);
/// Finds the pixels that show a mirror or glass with a reflection or refraction that is drawn as a separate
/// surface. The mirror or glass is the parent of this surface in the shading tree. Returns the bounding box
/// of these pixels, in px from the tile's corner.
[[nodiscard]] TilePart find_parents(const PatchMesh& mesh, const SeenTile& seen, const TilePlace& at);

/// Draws a patch (planar part of a surface) that is seen in a mirror or through glass. It is drawn, with a
/// depth test, only in the pixels of `wanted` that show its mirror or glass. `wanted` and `out` must come
/// from find_wanted. A patch that reprojection magnifies more than `largest_torn_px` times is left out.
void draw_patch_in(const PatchMesh& mesh, const Patch& patch, const PatchPlace& place, const TilePlace& tile,
                   const WantedPixels& wanted, SeenTile& out);
inline constexpr double largest_torn_px = 16;

}  // namespace postlens
