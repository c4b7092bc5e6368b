// What views of a tile see directly, added up.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "reproject/patch_raster.h"

namespace postlens {

/// By pixel of a tile: of all views that see anything there, colours times weights, and the weights.
using LightSums = std::array<std::array<double, 4>, SeenTile::pixels>;
/// Pixels of a tile, as many as there are.
struct PixelList {
    std::array<std::uint16_t, SeenTile::pixels> pixels{};
    std::size_t count = 0;
    [[nodiscard]] auto begin() const { return pixels.begin(); }
    [[nodiscard]] auto end() const { return pixels.begin() + static_cast<std::ptrdiff_t>(count); }
};

/// Adds the texels' own colours of what a view sees in the tile's first `width` x `height` pixels. Which of
/// them show mirrors or glass with something in it comes into `with_children`.
void add_seen_light(std::span<const Texel> texels, const SeenTile& seen, int width, int height, double weight,
                    LightSums& sums, PixelList& with_children);

}  // namespace postlens
