// The method `scatter` [potmesil1981]: distributes each sample's energy over its circle of confusion, and
// divides each pixel by the sum of the weights that it received. Exception: with
// SplatTables::let_nothing_fill, empty space supplies the missing weight if the sum is below 1.
#pragma once

#include "focus/scatter/splat_tables.h"
#include "pictures/image.h"

namespace postlens {

/// A pixel whose sum of weights is smaller is black.
inline constexpr double smallest_weight = 1e-12;

/// Edge of the blocks in which images are computed, px. The first block is at the upper left corner.
inline constexpr int scatter_block_px = 256;

/// Computes the pixels of the window tables.picture() and resizes `image` to it. Runs in parallel; the result
/// is bit-identical for any number of threads. If `wanted` is given, blocks outside this part of the image
/// are skipped; all others are the same as without `wanted`.
void scatter(const SplatTables& tables, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// Computes the image of scatter() directly from the definition: every impulse response is evaluated at every
/// pixel in double precision. A slow and simple reference for tests.
[[nodiscard]] Image scatter_reference(const SplatTables& tables);

}  // namespace postlens
