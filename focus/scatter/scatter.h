// Scatter [potmesil1981]: adds each sample's energy over its circle of confusion, and divides each pixel by
// the sum of the weights that it received (for an exception see SplatTables::let_nothing_fill).
#pragma once

#include "focus/scatter/splat_tables.h"
#include "pictures/image.h"

namespace postlens {

/// A pixel with a smaller sum of weights is black.
inline constexpr double smallest_weight = 1e-12;

/// Edge of the blocks in which images are made, px; the first block is at the upper left corner.
inline constexpr int scatter_block_px = 256;

/// Makes the image of the window `tables.picture()` and resizes `image`. Runs in parallel; the result is
/// bit-identical for any number of threads. With `wanted`, blocks outside of that part of the image are
/// skipped; the other blocks are bit-identical to those without it.
void scatter(const SplatTables& tables, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// Computes the image of scatter() by the definition, with every impulse response evaluated at every pixel in
/// double precision: a slow and simple reference for tests.
[[nodiscard]] Image scatter_reference(const SplatTables& tables);

}  // namespace postlens
