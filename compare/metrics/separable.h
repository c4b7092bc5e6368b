// Separable filters over a tile of an image, for FLIP and SSIM.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "core/threads.h"

namespace postlens {

/// Size, in px, of a tile of filtered pixels. Its data fit into the cache of a core. A filter of radius r
/// also reads r px beyond each side.
inline constexpr int tile_width = 128, tile_height = 64;

/// Calls body(x0, y0) in parallel for the tiles that cover width x height.
template <typename Body>
void for_each_tile(int width, int height, const Body& body) {
    const int columns = (width + tile_width - 1) / tile_width,
              rows = (height + tile_height - 1) / tile_height;
    parallel_for(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), [&](std::size_t i) {
        const int tile = static_cast<int>(i);
        body(tile % columns * tile_width, tile / columns * tile_height);
    });
}

/// One channel of a tile, i.e. of a rectangular part of an image, stored row by row. A filter of radius r
/// needs r px on each side of a pixel. Therefore, the filtered tile is smaller by r px on each side.
using TileChannel = std::vector<float>;

/// Filters a tile along rows: out[x] = sum_k taps[k] in[x + k]. Rows of `in` have tile_width + taps - 1
/// values, and those of `out` tile_width.
void filter_rows(const TileChannel& in, int rows, std::span<const float> taps, TileChannel& out);

/// Filters a tile along columns. `in` has tile_height + taps - 1 rows of tile_width values, and `out` has
/// tile_height.
void filter_columns(const TileChannel& in, std::span<const float> taps, TileChannel& out);

}  // namespace postlens
