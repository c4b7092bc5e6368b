// For each pixel of a tile, sums the radiance of directly visible surfaces over all views (images for one
// lens point and one instant each).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "reproject/patches/patch_raster.h"

namespace postlens {

/// Weighted sums over views for each pixel of a tile. The first three are the radiance (r, g, b) times the
/// view's weight. The fourth is the weight.
using LightSums = std::array<std::array<double, 4>, SeenTile::pixels>;
/// A list of pixels of a tile.
struct PixelList {
    std::array<std::uint16_t, SeenTile::pixels> pixels{};
    std::size_t count = 0;
    [[nodiscard]] auto begin() const { return pixels.begin(); }
    [[nodiscard]] auto end() const { return pixels.begin() + static_cast<std::ptrdiff_t>(count); }
};

/// Adds the colours that a view sees in the first `width` x `height` pixels of a tile to `sums`. A texel is
/// the recorded colour of one quadtree leaf. `with_children` receives the pixels whose surface reflects or
/// transmits other recorded surfaces.
void add_seen_light(std::span<const Texel> texels, const SeenTile& seen, int width, int height, double weight,
                    LightSums& sums, PixelList& with_children);

}  // namespace postlens
