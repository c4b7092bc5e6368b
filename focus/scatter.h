// Scatter [potmesil1981]: every sample's energy spread over its circle of confusion, normalised by the
// weights that arrive, and by nothing where that may fill what is left (SplatTables::let_nothing_fill).
#pragma once

#include "focus/splat_tables.h"
#include "records/image.h"

namespace postlens {

/// Below this sum of weights nothing is taken to have arrived at a pixel: it is black.
inline constexpr double smallest_weight = 1e-12;

/// Pictures are made in blocks of so many columns and rows, from their upper left.
inline constexpr int scatter_block_px = 256;

/// The picture of the tables' picture window, into an image that is made to fit. In parallel; the same bits
/// for any number of threads. With `wanted`, a part of that picture, the blocks that have nothing of it are
/// left out; the others have the same bits as without.
void scatter(const SplatTables& tables, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// The same from the definition, each response laid out in full, in double: slow and obvious, for tests.
[[nodiscard]] Image scatter_reference(const SplatTables& tables);

}  // namespace postlens
