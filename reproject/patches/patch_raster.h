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
    /// A flag in the elements of `texel`, which are numbers of recorded colours. This highest bit is set if
    /// the colour belongs to a reflection or refraction that cannot be reprojected accurately, for example in
    /// a curved mirror (Patch::bent).
    static constexpr std::uint32_t bent = 0x80000000U;

    /// Padding for SIMD code, which reads 16 values at a time, even beyond the end of the last row.
    static constexpr std::size_t slack = 16;

    alignas(64) std::array<float, pixels + slack> inverse_z{};
    alignas(64) std::array<std::uint32_t, pixels> texel{};
    /// For each pixel: inverse depth, in 1/m, of the nearest surface that possibly covers the pixel; -1 if
    /// there is none. Exact edges are not recorded, so between samples on both sides of an edge, the surface
    /// may or may not exist (SheetNode::maybe).
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
    /// Returns whether a rectangle, [x0, x1] x [y0, y1] in px from the tile's corner, may contain a pixel
    /// that was added. The result may be true without such a pixel, because only blocks of 8 x 8 px are
    /// stored.
    [[nodiscard]] bool any_in(float x0, float x1, float y0, float y1) const {
        constexpr auto end = static_cast<float>(SeenTile::edge);
        if (!(x1 >= 0 && x0 < end && y1 >= 0 && y0 < end)) return false;
        const auto block = [](float at) {
            return static_cast<unsigned>(std::clamp(at, 0.0F, end - 1)) / block_px;
        };
        // Returns a mask for the eight blocks of a row or column, in which the bits `from` to `to`, both
        // included, are set.
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
    /// Whether the array `in` contains gaps. A gap is a pixel in which a mirror or glass may be visible in
    /// another mirror or through other glass, but is not recorded.
    bool any_gaps = false;
    /// Returns the value of `in` for a gap. `id` is the nearest recorded object in which the mirror or glass
    /// would be seen.
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
/// Finds the pixels that show a mirror or glass whose reflection or refraction is drawn separately, as
/// patches (planar parts of surfaces) of its own. Returns the bounding box of these pixels, in px from the
/// tile's corner.
[[nodiscard]] TilePart find_parents(const PatchMesh& mesh, const SeenTile& seen, const TilePlace& at);

/// Draws a patch (planar part of a surface) that is seen in a mirror or through glass, with a depth test. It
/// is drawn only in the pixels that show its own mirror or glass. find_wanted has selected these pixels
/// (`wanted`), and has prepared `out`.
void draw_patch_in(const PatchMesh& mesh, const Patch& patch, const PatchPlace& place, const TilePlace& tile,
                   const WantedPixels& wanted, SeenTile& out);
/// A patch that is seen in a mirror or through glass is not drawn if the view magnifies it more than this
/// many times.
inline constexpr double largest_torn_px = 16;

}  // namespace postlens
