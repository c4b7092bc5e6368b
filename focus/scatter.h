// Scatter [potmesil1981]: adds each sample's energy over its circle of confusion, and divides each pixel by
// the sum of the weights that it received (for an exception see SplatTables::let_nothing_fill).
#pragma once

#include "focus/splat_tables.h"
#include "records/image.h"

namespace postlens {

/// A pixel with a smaller sum of weights is black.
inline constexpr double smallest_weight = 1e-12;

/// Edge of the blocks in which images are made, px; the first block is at the upper left corner.
inline constexpr int scatter_block_px = 256;

/// Makes the image of the tables' image window; resizes `image`. In parallel; bit-identical for any number of
/// threads. With `wanted`, blocks outside that part of the image are skipped; the others are the same bit for
/// bit.
void scatter(const SplatTables& tables, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// The same image, computed by the definition, with every impulse response evaluated at every pixel in double
/// precision: a slow and obvious reference for tests.
[[nodiscard]] Image scatter_reference(const SplatTables& tables);

}  // namespace postlens
