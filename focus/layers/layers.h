// The method `layers`. It blurs each surface separately, then composites the surfaces of each pixel in depth
// order.
#pragma once

#include "focus/layers/layer_splats.h"
#include "pictures/image.h"

namespace postlens {

/// Height of the blocks in which images are computed, in px.
inline constexpr int layers_block_px = 64;

/// Blurs the samples `splats` with the method `layers`, and stores the result in `image`. If `wanted` is set,
/// only the blocks of pixels that overlap this rectangle are computed. The result is bit-identical for any
/// number of threads.
void layers(const LayerSplats& splats, Image& image, const std::optional<Crop>& wanted = std::nullopt);

/// Computes the same image as layers(), but in the simplest way: it evaluates the impulse response of every
/// sample at every pixel. It is slow, and tests use it as a reference.
[[nodiscard]] Image layers_reference(const LayerSplats& splats);

}  // namespace postlens
