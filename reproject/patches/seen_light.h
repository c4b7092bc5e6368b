// For each pixel of a tile (square of the image): sums the radiance of directly visible surfaces over all
// views (images for one lens point and instant). Also finds the pixels whose colour in a view is uncertain,
// because the records do not determine which surface is visible there.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "reproject/patches/patch_raster.h"

namespace postlens {

/// Sums over the views (images for one lens point and instant) in a tile. For each pixel, the first three
/// values are the sums of weight * colour, and the fourth is the sum of the weights.
using LightSums = std::array<std::array<double, 4>, SeenTile::pixels>;
/// A list of pixels of a tile.
struct PixelList {
    std::array<std::uint16_t, SeenTile::pixels> pixels{};
    std::size_t count = 0;
    [[nodiscard]] auto begin() const { return pixels.begin(); }
    [[nodiscard]] auto end() const { return pixels.begin() + static_cast<std::ptrdiff_t>(count); }
};

/// Adds the colours of one view to `sums`, multiplied by the view's `weight`. This is done for the first
/// `width` x `height` pixels of a tile. For each of them, `seen` holds the index of its colour in `texels`.
/// `with_children` lists the pixels of mirrors and glass, whose reflected and refracted light is still
/// missing.
void add_seen_light(std::span<const Texel> texels, const SeenTile& seen, int width, int height, double weight,
                    LightSums& sums, PixelList& with_children);

/// Lists those of the first `width` x `height` pixels of a tile whose colour in a view is uncertain. A pixel
/// is listed
/// - if it shows no surface
/// - if a nearer surface with an unknown edge may hide the surface that it shows
/// - if its recorded colour in `texels` has one of the flags `doubts` in Texel::info
void find_doubtful_pixels(std::span<const Texel> texels, const SeenTile& seen, int width, int height,
                          std::uint32_t doubts, PixelList& found);

}  // namespace postlens
