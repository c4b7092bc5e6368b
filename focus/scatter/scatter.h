// The method `scatter` [potmesil1981]. It distributes the energy of each sample over the sample's circle of
// confusion. It then divides each pixel by the sum of the weights that the pixel received. If this sum is
// below 1, empty space may fill the rest of the pixel (SplatTables::let_nothing_fill).
#pragma once

#include "focus/scatter/splat_tables.h"
#include "pictures/image.h"

namespace postlens {

/// A pixel is black if its sum of weights is smaller than this.
inline constexpr double smallest_weight = 1e-12;

/// Edge of the blocks in which images are computed, in px. The first block is at the upper left corner.
inline constexpr int scatter_block_px = 256;

/// Computes the pixels of the window tables.picture() and resizes `image` to this window. If `wanted` is
/// given, blocks outside this part of the image are skipped. All other blocks are the same as without
/// `wanted`. Runs in parallel. The result is bit-identical for any number of threads.
void scatter(const SplatTables& tables, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// Computes the image of scatter() directly from the definition, by evaluating every impulse response at
/// every pixel in double precision. This is a slow and simple reference for tests.
[[nodiscard]] Image scatter_reference(const SplatTables& tables);

}  // namespace postlens
