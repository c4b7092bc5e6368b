// A view is the image for one lens point and instant. For each pixel of a tile, sums the radiance of directly
// visible surfaces over all views.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "reproject/patches/patch_raster.h"

namespace postlens {

/// A view is the image for one lens point and instant; each has its own weight. For each pixel of a tile: the
/// sums, over all views, of weight * r, weight * g, weight * b and weight.
using LightSums = std::array<std::array<double, 4>, SeenTile::pixels>;
/// A list of pixels of a tile.
struct PixelList {
    std::array<std::uint16_t, SeenTile::pixels> pixels{};
    std::size_t count = 0;
    [[nodiscard]] auto begin() const { return pixels.begin(); }
    [[nodiscard]] auto end() const { return pixels.begin() + static_cast<std::ptrdiff_t>(count); }
};

/// A view is the image for one lens point and instant. Adds a view's colours to `sums`, in the first `width`
/// x `height` pixels of a tile. Lists in `with_children` those pixels that show surfaces with reflections or
/// refractions.
void add_seen_light(std::span<const Texel> texels, const SeenTile& seen, int width, int height, double weight,
                    LightSums& sums, PixelList& with_children);

/// Lists those of the first `width` x `height` pixels of a tile whose colour in a view is not certain: they
/// show no surface, a nearer surface may hide what they show, or their texel has one of the bits `doubts` of
/// Texel::info.
void find_doubtful_pixels(std::span<const Texel> texels, const SeenTile& seen, int width, int height,
                          std::uint32_t doubts, PixelList& found);

}  // namespace postlens
