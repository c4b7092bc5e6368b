// The method `layers`. It scatters each surface into its own accumulator, then composites the surfaces of
// each pixel in depth order.
#pragma once

#include "focus/layers/layer_splats.h"
#include "pictures/image.h"

namespace postlens {

/// Height of the blocks in which images are computed, in px. The first block begins at the window's first
/// row.
inline constexpr int layers_block_px = 64;

/// Computes the pixels of the window splats.picture() and resizes `image` to this window. If `wanted` is
/// given, blocks outside this part of the image are skipped. Runs in parallel. The result is bit-identical
/// for any number of threads.
void layers(const LayerSplats& splats, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// Returns how many sums layers() computes for the whole image: in each block, one for each part of a surface
/// and each pixel that this part may reach. Where many surfaces are widely blurred, the sums take most of the
/// time.
[[nodiscard]] double layer_sums(const LayerSplats& splats);

/// Computes the image of layers() directly from the definition, by evaluating every impulse response at every
/// pixel. This is a slow and simple reference for tests.
[[nodiscard]] Image layers_reference(const LayerSplats& splats);

}  // namespace postlens
