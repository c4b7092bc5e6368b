// The method `scatter` [potmesil1981]. It spreads each sample over its circle of confusion. Then it divides
// the sum of colours in each pixel by the sum of the samples' weights.
#pragma once

#include "focus/scatter/splat_tables.h"
#include "pictures/image.h"

namespace postlens {

/// A pixel is black if the weights of its blurred samples add up to less than this.
inline constexpr double smallest_weight = 1e-12;

/// Edge of the blocks in which images are computed, in px.
inline constexpr int scatter_block_px = 256;

/// Computes the image in which all samples of `tables` are blurred, in parallel, and resizes `image` to the
/// window tables.picture(). Blocks of 256 x 256 px outside the part `wanted` are skipped. The result is
/// bit-identical for any number of threads.
void scatter(const SplatTables& tables, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// Computes the same image as scatter(), by evaluating every impulse response at every pixel in double
/// precision. It is a slow reference for tests.
[[nodiscard]] Image scatter_reference(const SplatTables& tables);

}  // namespace postlens
