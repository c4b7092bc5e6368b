// Layers: scatters every surface into an accumulator of its own, and composites the surfaces of each pixel in
// depth order.
#pragma once

#include "focus/layers/layer_splats.h"
#include "pictures/image.h"

namespace postlens {

/// Height of the blocks in which images are made, px; the first block begins at the window's first row.
inline constexpr int layers_block_px = 64;

/// Makes the image of the splats' image window and resizes `image`. Runs in parallel; the result is
/// bit-identical for any number of threads. `wanted`: blocks outside of this part of the image are skipped.
void layers(const LayerSplats& splats, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// Computes the image of layers() by the definition, with every impulse response evaluated at every pixel: a
/// slow and simple reference for tests.
[[nodiscard]] Image layers_reference(const LayerSplats& splats);

}  // namespace postlens
