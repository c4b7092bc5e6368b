// Sums, per pixel of a tile, the radiance of directly visible surfaces over all views (images for one lens
// point and instant).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "reproject/patches/patch_raster.h"

namespace postlens {

/// Sums over views (images for one lens point and instant), per pixel of a tile: r, g and b times the view's
/// weight, and the weight.
using LightSums = std::array<std::array<double, 4>, SeenTile::pixels>;
/// A list of pixels of a tile.
struct PixelList {
    std::array<std::uint16_t, SeenTile::pixels> pixels{};
    std::size_t count = 0;
    [[nodiscard]] auto begin() const { return pixels.begin(); }
    [[nodiscard]] auto end() const { return pixels.begin() + static_cast<std::ptrdiff_t>(count); }
};

/// Adds the colours that one view shows in the first `width` x `height` pixels of a tile to `sums`. Lists the
/// pixels whose surface has recorded reflections or refractions in `with_children`.
void add_seen_light(std::span<const Texel> texels, const SeenTile& seen, int width, int height, double weight,
                    LightSums& sums, PixelList& with_children);

}  // namespace postlens
