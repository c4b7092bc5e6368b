// Sums, per pixel of a tile, the radiance of directly visible surfaces over all views (images for one lens
// point and instant).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "reproject/patches/patch_raster.h"

namespace postlens {

/// For each pixel of a tile: the sums of weight * r, weight * g, weight * b and weight over all views (images
/// for one lens point and instant). Each view has its own weight.
using LightSums = std::array<std::array<double, 4>, SeenTile::pixels>;
/// A list of pixels of a tile.
struct PixelList {
    std::array<std::uint16_t, SeenTile::pixels> pixels{};
    std::size_t count = 0;
    [[nodiscard]] auto begin() const { return pixels.begin(); }
    [[nodiscard]] auto end() const { return pixels.begin() + static_cast<std::ptrdiff_t>(count); }
};

/// Adds the colours of one view (image for one lens point and instant) in the first `width` x `height` pixels
/// of a tile to `sums`. Stores in `with_children` which of these pixels show a surface with reflections or
/// refractions.
void add_seen_light(std::span<const Texel> texels, const SeenTile& seen, int width, int height, double weight,
                    LightSums& sums, PixelList& with_children);

}  // namespace postlens
