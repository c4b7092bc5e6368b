// For each pixel of a tile (square of the image): sums the radiance of directly visible surfaces over all
// views, and finds the pixels whose colour in a view is not certain. A view is the image for one lens point
// and instant.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "reproject/patches/patch_raster.h"

namespace postlens {

/// Sums over the views (images for one lens point and instant), for each pixel of a tile. Each view has its
/// own weight. The four values of a pixel are the sums of weight * r, weight * g, weight * b and weight. So
/// the first three divided by the fourth are the mean colour.
using LightSums = std::array<std::array<double, 4>, SeenTile::pixels>;
/// A list of pixels of a tile.
struct PixelList {
    std::array<std::uint16_t, SeenTile::pixels> pixels{};
    std::size_t count = 0;
    [[nodiscard]] auto begin() const { return pixels.begin(); }
    [[nodiscard]] auto end() const { return pixels.begin() + static_cast<std::ptrdiff_t>(count); }
};

/// Adds the colours of one view (image for one lens point and instant) to `sums`, for the first `width` x
/// `height` pixels of a tile. `seen` tells which recorded colour of `texels` each pixel shows, and `weight`
/// is the weight of the view. Lists in `with_children` those pixels that show surfaces with reflections or
/// refractions, whose light must be added separately.
void add_seen_light(std::span<const Texel> texels, const SeenTile& seen, int width, int height, double weight,
                    LightSums& sums, PixelList& with_children);

/// Lists those of the first `width` x `height` pixels of a tile whose colour in a view is not certain: they
/// show no surface, a nearer surface may hide what they show, or their texel has one of the bits `doubts` of
/// Texel::info.
void find_doubtful_pixels(std::span<const Texel> texels, const SeenTile& seen, int width, int height,
                          std::uint32_t doubts, PixelList& found);

}  // namespace postlens
