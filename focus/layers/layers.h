// The method `layers`: scatters each surface into its own accumulator, and composites the surfaces of each
// pixel in depth order.
#pragma once

#include "focus/layers/layer_splats.h"
#include "pictures/image.h"

namespace postlens {

/// Height of the blocks in which images are computed, px. The first block begins at the window's first row.
inline constexpr int layers_block_px = 64;

/// Computes the image of the splats' image window and resizes `image`. Runs in parallel; the result is
/// bit-identical for any number of threads. With `wanted`, blocks outside of this part of the image are
/// skipped.
void layers(const LayerSplats& splats, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// Computes the image of layers() directly from the definition: every impulse response is evaluated at every
/// pixel. A slow and simple reference for tests.
[[nodiscard]] Image layers_reference(const LayerSplats& splats);

}  // namespace postlens
